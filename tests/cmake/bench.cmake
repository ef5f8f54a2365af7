# Benchmarks: programs that print figures; ctest does not run them.
add_executable(yardstick bench/yardstick.cpp)
target_link_libraries(yardstick PRIVATE nf_passes nf_options)
target_compile_definitions(yardstick PRIVATE NF_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
# Where Google Benchmark is (Debian's libbenchmark-dev).
find_package(benchmark QUIET)
if(benchmark_FOUND)
  add_executable(culling_bench bench/culling_bench.cpp)
  target_link_libraries(culling_bench PRIVATE nf_scene benchmark::benchmark nf_options)
  add_executable(graph_bench bench/graph_bench.cpp)
  target_link_libraries(graph_bench PRIVATE nf_passes benchmark::benchmark nf_options)
  target_compile_definitions(graph_bench PRIVATE NF_BINARY_DIR="${CMAKE_BINARY_DIR}")
endif()
