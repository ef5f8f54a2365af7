nf_test(core_test nf_core LABELS cpu)
