#pragma once

#include <string>

/// Where tests find what is theirs. Only places.cpp is compiled with these paths: objects of tests
/// are the same in every clone, and one clone takes from the compiler's cache what another has put
/// there.
namespace cycloid::places {

/// Absolute. @param path  From the root of the repository: "docs/server.md".
std::string source(const std::string& path);

/// The program, and two of it that each have an error in the solver.
std::string program();
std::string wrong_friction_program();
std::string wrong_velocity_program();

/// A library that has the processor flush small numbers to zero, to be loaded by a test.
std::string flushing_library();

/// The library of client/c, its example, and what lists the names of a library. Empty in a build
/// without network.
std::string c_library();
std::string c_example();
std::string name_lister();

}  // namespace cycloid::places
