nf_test(lighting_test nf_passes LABELS cpu)
