#include "scenes/zero_signs.hpp"

#include <type_traits>

#include "scenes/fields.hpp"

namespace cycloid::scenes {

/// Visits whatever a scene holds, down to the numbers.
struct ZeroSigns {
  void drop(float& value) const {
    if (value == 0.0f) value = 0.0f;
  }
  void drop(std::string&) const {}
  template <class Number>
  requires std::is_integral_v<Number> || std::is_enum_v<Number>
  void drop(Number&) const {}
  template <class Number, std::size_t N>
  void drop(std::array<Number, N>& values) const {
    for (Number& value : values) drop(value);
  }
  template <class Element>
  void drop(std::vector<Element>& elements) const {
    for (Element& element : elements) drop(element);
  }
  template <HasFields Part>
  void drop(Part& part) const {
    fields(part, [this](const char*, auto& field) { this->drop(field); });
  }
};

void drop_zero_signs(Scene& scene) {
  ZeroSigns{}.drop(scene);
}

}  // namespace cycloid::scenes
