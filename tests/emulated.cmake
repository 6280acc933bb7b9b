# SPDX-License-Identifier: Apache-2.0
# The tests that a cross build runs under an emulator, ten to thirty times slower than at home:
# arithmetic, engine, proofs and decisions, whose bits must not depend on the processor. Left out is
# what starts processes of its own, reads real data, or takes minutes there.
set(AXG_EMULATED
  unit.arena_test unit.axis_receiver_test unit.box_proof_test unit.containment_test
  unit.e2e_test unit.engine_test unit.finite_test unit.guard_frames_test unit.guard_state_test
  unit.monitor_test unit.refused_questions_test unit.sincos_test unit.stl_test unit.stop_plan_test
  unit.tree_test unit.winding_test
  property.box_proof_test property.certified_pairs_test property.containment_test
  property.engine_metamorphic_test property.engine_test property.kinematics_test
  property.stop_reach_test
  parity.contraction_test)
add_custom_target(emulated_tests DEPENDS axguard axguardd axg_c guard_a_trace axg_lane_hash
                  axg_make_scene)
foreach(name IN LISTS AXG_EMULATED)
  string(REPLACE "." "_" target ${name})
  add_dependencies(emulated_tests ${target})
  set_property(TEST ${name} APPEND PROPERTY LABELS emulated)
  if(CMAKE_CROSSCOMPILING AND name MATCHES "^property")  # at the usual counts some take minutes
    set_property(TEST ${name} PROPERTY ENVIRONMENT AXG_COUNT=200)
  endif()
endforeach()
