#include "tests/places.hpp"

namespace cycloid::places {

std::string source(const std::string& path) {
  return CYCLOID_SOURCE_DIR "/" + path;
}

std::string program() {
  return CYCLOID_PROGRAM;
}
std::string wrong_friction_program() {
  return CYCLOID_WRONG_FRICTION;
}
std::string wrong_velocity_program() {
  return CYCLOID_WRONG_VELOCITY;
}

std::string flushing_library() {
  return CYCLOID_FLUSHING_LIBRARY;
}

std::string c_library() {
  return CYCLOID_C_LIBRARY;
}
std::string c_example() {
  return CYCLOID_C_EXAMPLE;
}
std::string name_lister() {
  return CYCLOID_NM;
}

}  // namespace cycloid::places
