# SPDX-License-Identifier: Apache-2.0
# A room is a folder with one subject: one library of the same name, its files listed. What it links
# is what it may include; tests/style/layers.py holds the includes to that, and to one direction.

# axg_room([SOURCES FILE...] [ROOMS FOLDER...] [LIBRARIES LIBRARY...] [TEXT])
# The library axg_HOUSE_ROOM (axg::HOUSE_ROOM) of this folder. A room without sources has headers
# alone. TEXT: it reads options and writes reports, whose templates take a third more to compile at
# -O3 and no time when they run.
function(axg_room)
  cmake_parse_arguments(room "TEXT" "" "SOURCES;ROOMS;LIBRARIES" ${ARGN})
  axg_room_target(target "")
  set(links ${room_LIBRARIES})
  foreach(other IN LISTS room_ROOMS)
    axg_room_target(linked ${other})
    list(APPEND links ${linked})
  endforeach()
  if(room_SOURCES)
    add_library(${target} STATIC ${room_SOURCES})
    target_link_libraries(${target} PUBLIC axg::flags ${links})
    if(room_TEXT)
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    endif()
    set_property(GLOBAL APPEND PROPERTY AXG_ROOMS ${target})
  else()
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE axg::flags ${links})
  endif()
  string(REGEX REPLACE "^axg_" "axg::" alias ${target})
  add_library(${alias} ALIAS ${target})
  set(AXG_ROOM ${target} PARENT_SCOPE)
endfunction()

# The name of a room's library: of the folder given, or of this one.
function(axg_room_target out folder)
  if(NOT folder)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  endif()
  string(REPLACE "/" "_" folder ${folder})
  set(${out} axg_${folder} PARENT_SCOPE)
endfunction()

# All rooms of a house by one name, for tests and for whoever needs the whole of it.
function(axg_house folder)
  axg_room_target(house ${folder})
  string(REGEX REPLACE "^axg_" "axg::" alias ${house})
  add_library(${house} INTERFACE)
  add_library(${alias} ALIAS ${house})
  foreach(room IN LISTS ARGN)
    add_subdirectory(${room})
    target_link_libraries(${house} INTERFACE ${house}_${room})
  endforeach()
endfunction()
