# SPDX-License-Identifier: Apache-2.0
# The cross build's axguardd on real CAN, in a whole aarch64 machine (boot_machine.py). The traces
# are made under the emulator that CMake runs programs of this build with.
set(guest AXG_GUEST=${PROJECT_SOURCE_DIR}/build/guest-arm64)
set(traces ${PROJECT_BINARY_DIR}/can_vm)
file(MAKE_DIRECTORY ${traces})
add_custom_target(machine_tests DEPENDS axguard axguardd)
foreach(format classical fd)
  set(options)
  if(format STREQUAL "fd")
    set(options --fd)
  endif()
  add_test(NAME machine.trace_${format} COMMAND axguard simulate
    ${PROJECT_SOURCE_DIR}/config/machines/paper-trunnion.yaml
    ${CMAKE_CURRENT_SOURCE_DIR}/rest_collide.ngc -o ${traces}/collide-${format}.log --sample-us 5000
    ${options})
  set_tests_properties(machine.trace_${format} PROPERTIES LABELS machine TIMEOUT 120
    FIXTURES_SETUP machine_traces)
  add_test(NAME machine.replay_${format} COMMAND ${Python3_EXECUTABLE} -B
    ${CMAKE_CURRENT_SOURCE_DIR}/boot_machine.py replay.py ${format} contact)
  set_tests_properties(machine.replay_${format} PROPERTIES LABELS machine TIMEOUT 600
    FIXTURES_REQUIRED machine_traces SKIP_RETURN_CODE ${AXG_SKIPPED_RETURN_CODE}
    ENVIRONMENT "AXG_BUILD=${PROJECT_BINARY_DIR};AXG_SOURCE=${PROJECT_SOURCE_DIR};${guest}")
endforeach()
