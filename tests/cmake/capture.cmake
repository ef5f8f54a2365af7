nf_test(capture_test nf_capture LABELS cpu)
