#pragma once

#include "solver/trig.hpp"

namespace cycloid::solver {

/// Sine and cosine of W angles [rad]: what solver/trig.cpp gives for each, to the bit.
template <int W>
[[gnu::always_inline]] inline void sin_cos(const Lanes<W>& angle, Lanes<W>& sine,
                                           Lanes<W>& cosine) {
  using L = Lanes<W>;
  using Mask = typename L::Mask;
  const L x = max(L(-1.0e6f), min(angle, L(1.0e6f)));
  const L quarters = x * L(2.0f / kPi);
  const L half = select(quarters < L(0.0f), L(-0.5f), L(0.5f));
  const Mask k = __builtin_convertvector((quarters + half).raw, Mask);
  const L n(__builtin_convertvector(k, typename L::Raw));
  const L r =
      ((x - n * L(1.5703125f)) - n * L(4.837512969970703e-4f)) - n * L(7.549789948768648e-8f);
  const L z = r * r;
  const L s =
      ((L(-1.9515295891e-4f) * z + L(8.3321608736e-3f)) * z - L(1.6666654611e-1f)) * z * r + r;
  const L c =
      ((L(2.443315711809948e-5f) * z - L(1.388731625493765e-3f)) * z + L(4.166664568298827e-2f)) *
          z * z -
      L(0.5f) * z + L(1.0f);
  const Mask odd = (k & 1) != 0;
  const L first = select(odd, c, s);
  const L second = select(odd, s, c);
  sine = select((k & 2) != 0, -first, first);
  cosine = select(((k + 1) & 2) != 0, -second, second);
}

}  // namespace cycloid::solver
