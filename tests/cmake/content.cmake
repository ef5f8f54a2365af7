nf_test(content_test nf_content LABELS cpu)
