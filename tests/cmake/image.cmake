nf_test(image_test nf_image LABELS cpu)
nf_test(metrics_test nf_image LABELS cpu)
nf_test(error_split_test nf_image LABELS cpu)
nf_test(temporal_measures_test nf_image LABELS cpu)
