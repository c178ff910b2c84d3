// For targets whose C++ library has no exceptions (WebAssembly): what `throw` calls there. Nothing
// can be caught, so a throw says what it would have said in main, and ends the program.

#include <cstdlib>
#include <iostream>
#include <typeinfo>

#include "cli/output.hpp"

extern "C" void* __cxa_allocate_exception(std::size_t bytes) noexcept {
  return std::malloc(bytes);
}

extern "C" [[noreturn]] void __cxa_throw(void* thrown, std::type_info* type, void* (*)(void*)) {
  using cycloid::cli::Failure;
  std::cout.flush();
  if (*type == typeid(Failure)) {
    const auto& failure = *static_cast<const Failure*>(thrown);
    std::cerr << "cycloid: " << failure.what() << '\n';
    std::exit(failure.exit);
  }
  std::cerr << "cycloid: an exception that cannot be caught on this target: " << type->name()
            << '\n';
  std::abort();
}
