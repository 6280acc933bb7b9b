# SPDX-License-Identifier: Apache-2.0
# The tests that a cross build runs under an emulator, ten to thirty times slower than at home:
# arithmetic, engine, proofs and decisions, whose bits must not depend on the processor. Left out is
# what starts processes of its own, reads real data, or takes minutes there.
set(AXG_EMULATED_unit
  arena axis_receiver joint_box_proof containment e2e engine finite guard_frames guard_state monitor
  refused_queries sincos stl stop_certificate tree winding)
set(AXG_EMULATED_property
  joint_box_proof certified_pairs containment engine_metamorphic engine kinematics stop_reach)
set(AXG_EMULATED_parity contraction)
foreach(kind unit property parity)
  list(TRANSFORM AXG_EMULATED_${kind} APPEND "_test")
  list(JOIN AXG_EMULATED_${kind} "|" AXG_EMULATED_${kind})
endforeach()

function(axg_emulated_tests)
  add_custom_target(emulated_tests DEPENDS axguard axguardd axg_c guard_a_trace axg_lane_hash
                    unit_tests property_tests parity_tests)
  foreach(kind unit property parity)
    string(REPLACE "|" ";" names "${AXG_EMULATED_${kind}}")
    foreach(name IN LISTS names)
      set_property(TEST ${kind}.${name} APPEND PROPERTY LABELS emulated)
    endforeach()
  endforeach()
  # At the usual counts some take minutes.
  foreach(count joint_box_proof_test=20 certified_pairs_test=30000 containment_test=20
          engine_metamorphic_test=200 engine_test=200 stop_reach_test=2000)
    string(REGEX MATCH "(.*)=(.*)" matched ${count})
    set_property(TEST property.${CMAKE_MATCH_1} PROPERTY ENVIRONMENT AXG_COUNT=${CMAKE_MATCH_2})
  endforeach()
  # NEON is the one set of lanes there; equal_verdicts.sh compares it with those of other builds.
  set_property(TEST property.engine_test APPEND PROPERTY ENVIRONMENT
               GTEST_FILTER=-EngineProperty.EveryLaneSetGivesEqualBits)
endfunction()
