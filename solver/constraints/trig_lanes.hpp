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

/// The angles of W points (x, y) in (-pi, pi]: what solver/trig.cpp gives for each, to the bit. One
/// quotient stands for the three ways there to reduce it.
template <int W>
[[gnu::always_inline]] inline Lanes<W> atan2(const Lanes<W>& y, const Lanes<W>& x) {
  using L = Lanes<W>;
  const L ax = select(x < L(0.0f), -x, x);
  const L ay = select(y < L(0.0f), -y, y);
  const auto slanted = ax > L(0.0f);
  const L t = ay / select(slanted, ax, L(1.0f));
  const auto steep = t > L(2.414213562373095f);
  const auto middling = t > L(0.4142135623730950f);
  const L base = select(steep, L(kPi * 0.5f), select(middling, L(kPi * 0.25f), L(0.0f)));
  const L over = select(steep, L(-1.0f), select(middling, t - L(1.0f), t));
  const L under = select(steep, t, select(middling, t + L(1.0f), L(1.0f)));
  const L r = over / under;
  const L z = r * r;
  const L p = ((L(8.05374449538e-2f) * z - L(1.38776856032e-1f)) * z + L(1.99777106478e-1f)) * z -
              L(3.33329491539e-1f);
  const L first = select(slanted, base + (p * z * r + r), L(kPi * 0.5f));
  const L half = select(x < L(0.0f), L(kPi) - first, first);
  const L angle = select(y < L(0.0f), -half, half);
  return select(max(ax, ay) > L(0.0f), angle, L(0.0f));
}

}  // namespace cycloid::solver
