# The visibility-bitmask mathematics: the shaders' own text compiled as C++ (glsl_twin.h).
foreach(name bitmask_math_test bitmask_integral_test bitmask_texel_test bitmask_estimator_test bitmask_sampling_test bitmask_span_test slice_forms_test)
  nf_test(${name} nf_core glm::glm LABELS cpu)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/shaders ${CMAKE_SOURCE_DIR}/passes ${CMAKE_CURRENT_SOURCE_DIR})
endforeach()
