// Compiled with -fassociative-math, whose macros are taken away so that the headers let it pass:
// only the check that is inlined into a caller of World::create can tell.

#include "tests/refusals/reordering_user.hpp"

namespace cycloid::solver {

const char* field_refused_to_a_reordering_user() {
  return World<2>::create({}).error().field;
}

}  // namespace cycloid::solver
