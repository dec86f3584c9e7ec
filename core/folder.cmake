# A folder of the sources, and what it may include: a wrong include does not compile.
#
#   raycone_folder(core/exact SEES core/data core/machine SOURCES predicates.cpp ... [USES CGAL::CGAL ...])
#
# makes two targets:
#   core_exact_headers  gives its users the include path of this folder and of the folders that it SEES
#   core_exact          the object files of SOURCES, compiled with just that path; USES are the libraries they need
# The include path is a directory of the build that holds nothing but a link to the folder, under the folder's full
# name.
function(raycone_folder folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SEES;SOURCES;USES")
  string(REPLACE / _ name ${folder})
  cmake_path(GET folder PARENT_PATH parent)
  set(include_path ${PROJECT_BINARY_DIR}/include_paths/${name})
  file(MAKE_DIRECTORY ${include_path}/${parent})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${include_path}/${folder} SYMBOLIC)

  add_library(${name}_headers INTERFACE)
  target_include_directories(${name}_headers INTERFACE ${include_path})
  foreach(seen IN LISTS arg_SEES)
    string(REPLACE / _ seen ${seen})
    target_link_libraries(${name}_headers INTERFACE ${seen}_headers)
  endforeach()
  set_property(GLOBAL APPEND PROPERTY raycone_folders ${folder})

  if(arg_SOURCES)
    add_library(${name} OBJECT ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE raycone_flags ${name}_headers ${arg_USES})
    if(RAYCONE_UNITY)
      set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
      # To GCC a file's own types look like a header's then.
      target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    endif()
  endif()
endfunction()

# A static library of the object files of folders.
function(raycone_library name)
  add_library(${name} STATIC)
  foreach(folder IN LISTS ARGN)
    string(REPLACE / _ folder ${folder})
    if(TARGET ${folder})
      target_sources(${name} PRIVATE $<TARGET_OBJECTS:${folder}>)
    endif()
  endforeach()
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX)
endfunction()
