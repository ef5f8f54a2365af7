# Benchmarks: programs that print figures; ctest does not run them.
add_executable(yardstick bench/yardstick.cpp)
target_link_libraries(yardstick PRIVATE nf_passes nf_options)
target_compile_definitions(yardstick PRIVATE NF_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
add_executable(reference_rays bench/reference_rays.cpp)
target_link_libraries(reference_rays PRIVATE nf_reference embree nf_options)
