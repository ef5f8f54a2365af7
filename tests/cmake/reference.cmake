foreach(name reference_test reference_blend_test reference_light_test reference_sampling_test same_information_test)
  nf_test(${name} nf_reference nf_content LABELS cpu)
endforeach()
