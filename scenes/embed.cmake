# cmake -DOUTPUT=FILE -DSCENES="a.json;b.json" -P embed.cmake
# Writes a source file that holds the scenes as text, each under its file's name without ".json".
set(texts "")
set(rows "")
set(number 0)
foreach(file IN LISTS SCENES)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} json)
  # Compilers limit one literal; adjacent ones are joined.
  string(LENGTH "${json}" length)
  set(literals "")
  set(at 0)
  while(at LESS length)
    string(SUBSTRING "${json}" ${at} 8000 part)
    string(APPEND literals "\n    R\"scene(${part})scene\"")
    math(EXPR at "${at} + 8000")
  endwhile()
  string(APPEND texts "static constexpr char kText${number}[] =${literals};\n")
  # With its length: to count 70 kB while compiling is more than Clang lets a constant cost.
  string(APPEND rows "    {\"${name}\", {kText${number}, sizeof kText${number} - 1}},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT} "#include \"scenes/embedded.hpp\"

namespace cycloid::scenes {

${texts}
static constexpr EmbeddedScene kScenes[] = {
${rows}};

std::span<const EmbeddedScene> embedded_scenes() { return kScenes; }

}  // namespace cycloid::scenes
")
