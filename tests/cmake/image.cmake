nf_test(image_test nf_image LABELS cpu)
