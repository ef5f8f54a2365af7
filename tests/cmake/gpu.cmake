# Tests on the device, under validation.
add_library(nf_gpu_fixture STATIC gpu_fixture.cpp)
target_include_directories(nf_gpu_fixture PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(nf_gpu_fixture PRIVATE NF_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
target_link_libraries(nf_gpu_fixture PUBLIC nf_passes nf_content nf_image GTest::gtest PRIVATE nf_options)
foreach(name gpu_frame_test gpu_robust_test gpu_graph_test gpu_graph_use_test gpu_live_test gpu_motion_test gpu_shader_test
             gpu_shadow_test gpu_shadow_cache_test
             gpu_blend_test gpu_reload_test gpu_probe_test gpu_freeze_test gpu_memory_test gpu_nan_test gpu_inspect_test gpu_edit_test gpu_pictures_test gpu_techniques_test gpu_forms_test gpu_marcher_test)
  if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${name}.cpp)
    nf_test(${name} nf_gpu_fixture LABELS gpu)
  endif()
endforeach()
target_link_libraries(gpu_techniques_test PRIVATE nf_reference)
target_include_directories(gpu_techniques_test PRIVATE ${CMAKE_SOURCE_DIR}/shaders)
target_include_directories(gpu_probe_test PRIVATE ${CMAKE_SOURCE_DIR}/shaders)
target_link_libraries(gpu_motion_test PRIVATE meshoptimizer::meshoptimizer ${NF_DRACO})
# Shaders being edited: the watch and the errors' places need no device.
nf_test(shader_watch_test nf_gpu LABELS cpu)
