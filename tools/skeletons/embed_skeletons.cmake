# cmake -DROOT=project -DOUT=embedded_skeletons.cc -P embed_skeletons.cmake: the files that
# `rubric new-adapter` and `new-protocol` write, as C++ text. Python's loops are those of adapters
# that ship.
set(text "// Generated from tools/skeletons when the program is built.
#include \"tools/commands/new/new_adapter.h\"

namespace rubric::tools {

const std::vector<SkeletonFile>& skeleton_files() {
  static const std::vector<SkeletonFile> files = {\n")
function(add_file language name path)
  file(READ ${ROOT}/${path} content)
  string(REPLACE "rubric_python_mote 1.0" "my_mote 0.1" content "${content}")
  string(APPEND text "      {\"${language}\", \"${name}\", R\"skeleton(${content})skeleton\"},\n")
  set(text "${text}" PARENT_SCOPE)
endfunction()
add_file(python adapter.py conformance/adapters/python/adapter.py)
add_file(python words.py conformance/adapters/python/words.py)
add_file(python mote.py tools/skeletons/python/mote.py)
add_file(cpp adapter.cc tools/skeletons/cpp/adapter.cc)
add_file(cpp my_node.h tools/skeletons/cpp/my_node.h)
add_file(java Adapter.java tools/skeletons/java/Adapter.java)
add_file(java MyNode.java tools/skeletons/java/MyNode.java)
add_file(java World.java tools/skeletons/java/World.java)
foreach(name README.md app.yaml cases/protocol.rtr node.py protocol.ksy requirements.yaml)
  add_file(protocol ${name} tools/skeletons/protocol/${name})
endforeach()
add_file(protocol rct.py conformance/protocols/ctp/rct.py)
string(APPEND text "  };
  return files;
}

}  // namespace rubric::tools\n")
file(WRITE ${OUT} "${text}")
