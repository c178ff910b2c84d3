#include "solver/trig.hpp"

namespace cycloid::solver {

void sin_cos(float angle, float& sine, float& cosine) {
  const float x = clamp(angle, -1.0e6f, 1.0e6f);
  const float quarters = x * (2.0f / kPi);
  const int k = static_cast<int>(quarters < 0.0f ? quarters - 0.5f : quarters + 0.5f);
  const float n = static_cast<float>(k);
  // pi/2 in three parts; the first two have few enough bits for n * part to be exact.
  const float r = ((x - n * 1.5703125f) - n * 4.837512969970703e-4f) - n * 7.549789948768648e-8f;
  const float z = r * r;
  const float s = ((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f) * z * r + r;
  const float c =
      ((2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f) * z * z -
      0.5f * z + 1.0f;
  switch (k & 3) {
    case 0:
      sine = s;
      cosine = c;
      break;
    case 1:
      sine = c;
      cosine = -s;
      break;
    case 2:
      sine = -s;
      cosine = -c;
      break;
    default:
      sine = -c;
      cosine = s;
      break;
  }
}

/// atan on [0, inf): reduced at tan(pi/8) and tan(3 pi/8), then a polynomial. Source: Cephes.
static float atan_positive(float t) {
  float base = 0.0f;
  if (t > 2.414213562373095f) {
    base = kPi * 0.5f;
    t = -1.0f / t;
  } else if (t > 0.4142135623730950f) {
    base = kPi * 0.25f;
    t = (t - 1.0f) / (t + 1.0f);
  }
  const float z = t * t;
  const float p =
      ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z - 3.33329491539e-1f;
  return base + (p * z * t + t);
}

float atan2(float y, float x) {
  if (x == 0.0f && y == 0.0f) return 0.0f;
  const float ax = abs(x);
  const float ay = abs(y);
  const float first = ax > 0.0f ? atan_positive(ay / ax) : kPi * 0.5f;
  const float half = x < 0.0f ? kPi - first : first;
  return y < 0.0f ? -half : half;
}

}  // namespace cycloid::solver
