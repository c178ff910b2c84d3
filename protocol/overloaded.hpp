#pragma once

namespace cycloid::protocol {

/// A handler for std::visit of several lambdas, one for each kind of message.
template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
// Implied by C++20, but Clang before 17 does not know.
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

}  // namespace cycloid::protocol
