# SPDX-License-Identifier: Apache-2.0
# The tests that a cross build runs under an emulator, ten to thirty times slower than at home:
# arithmetic, engine, proofs and decisions, whose bits must not depend on the processor. Left out is
# what starts processes of its own, reads real data, or takes minutes there.
if(NOT CMAKE_CROSSCOMPILING)
  return()
endif()
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
endforeach()
# At the usual counts some take minutes.
foreach(count box_proof_test=20 certified_pairs_test=30000 containment_test=20
        engine_metamorphic_test=200 engine_test=200 stop_reach_test=2000)
  string(REGEX MATCH "(.*)=(.*)" matched ${count})
  set_property(TEST property.${CMAKE_MATCH_1} PROPERTY ENVIRONMENT AXG_COUNT=${CMAKE_MATCH_2})
endforeach()
# NEON is the one set of lanes there; equal_verdicts.sh compares it with those of other builds.
set_property(TEST property.engine_test APPEND PROPERTY ENVIRONMENT
             GTEST_FILTER=-EngineProperty.EveryLaneSetAnswersInEqualBits)
