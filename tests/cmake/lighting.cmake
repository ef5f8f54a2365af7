nf_test(lighting_test nf_passes LABELS cpu)
target_include_directories(lighting_test PRIVATE ${CMAKE_SOURCE_DIR}/shaders ${CMAKE_CURRENT_SOURCE_DIR})
