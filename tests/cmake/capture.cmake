foreach(name capture_test capture_run_test)
  nf_test(${name} nf_capture LABELS cpu)
endforeach()
