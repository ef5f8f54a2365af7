# The frame graph as a value: no device is needed.
foreach(name graph_test graph_dump_test graph_validate_test graph_hazard_test graph_probe_test place_test)
  nf_test(${name} nf_graph LABELS cpu)
endforeach()
