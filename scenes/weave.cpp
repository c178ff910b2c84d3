#include "scenes/weave.hpp"

#include <algorithm>

namespace cycloid::scenes {

template <int D>
static solver::Vec<D> place_of(const Cloth& cloth, std::uint32_t column, std::uint32_t row) {
  solver::Vec<D> place;
  for (int i = 0; i < D; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    place[i] = cloth.origin[axis] + static_cast<float>(column) * cloth.across[axis] +
               static_cast<float>(row) * cloth.down[axis];
  }
  return place;
}

template <int D>
class Weaver {
 public:
  Weaver(const Cloth& cloth, solver::World<D>& world, Weave& weave)
      : cloth_(cloth), world_(world), weave_(weave) {}

  std::string link_all() {
    for (std::uint32_t row = 0; row < cloth_.rows; ++row)
      for (std::uint32_t column = 0; column + 1 < cloth_.columns; ++column)
        link(column, row, column + 1, row, cloth_.compliance, "across");
    for (std::uint32_t row = 0; row + 1 < cloth_.rows; ++row)
      for (std::uint32_t column = 0; column < cloth_.columns; ++column)
        link(column, row, column, row + 1, cloth_.compliance, "down");
    if (cloth_.shear_compliance < 0.0f) return mistake_;
    for (std::uint32_t row = 0; row + 1 < cloth_.rows; ++row)
      for (std::uint32_t column = 0; column + 1 < cloth_.columns; ++column) {
        link(column, row, column + 1, row + 1, cloth_.shear_compliance, "shear_compliance");
        link(column + 1, row, column, row + 1, cloth_.shear_compliance, "shear_compliance");
      }
    return mistake_;
  }

 private:
  void link(std::uint32_t column_a, std::uint32_t row_a, std::uint32_t column_b,
            std::uint32_t row_b, float compliance, const char* field) {
    if (!mistake_.empty()) return;
    solver::LinkDef def;
    def.particle_a = weave_[row_a * cloth_.columns + column_a];
    def.particle_b = weave_[row_b * cloth_.columns + column_b];
    def.length =
        solver::length(place_of<D>(cloth_, column_b, row_b) - place_of<D>(cloth_, column_a, row_a));
    def.compliance = compliance;
    if (!world_.create_link(def).ok()) mistake_ = field;
  }

  const Cloth& cloth_;
  solver::World<D>& world_;
  Weave& weave_;
  std::string mistake_;
};

template <int D>
std::string weave_cloth(const Cloth& cloth, std::uint32_t material, solver::World<D>& world,
                        Weave& weave) {
  const solver::Limits& limits = world.state().header.limits;
  const std::size_t live = world.state().particles.size();
  if (live > limits.particles || live > kClothParticlesMax) return "columns";
  const auto room = std::min<std::size_t>(limits.particles, kClothParticlesMax) - live;
  if (cloth.columns < 1 || cloth.columns > room) return "columns";
  if (cloth.rows < 1 || cloth.rows > room / cloth.columns) return "rows";
  for (std::uint32_t row = 0; row < cloth.rows; ++row)
    for (std::uint32_t column = 0; column < cloth.columns; ++column) {
      solver::ParticleDef<D> def;
      def.position = place_of<D>(cloth, column, row);
      def.mass = cloth.mass;
      def.radius = cloth.radius;
      def.material = material;
      def.filter = cloth.filter;
      const auto id = world.create_particle(def);
      if (!id.ok())
        return std::string(id.error().field) == "position" ? "origin" : id.error().field;
      weave.push_back(id.value());
    }
  return Weaver<D>(cloth, world, weave).link_all();
}

template std::string weave_cloth(const Cloth&, std::uint32_t, solver::World<2>&, Weave&);
template std::string weave_cloth(const Cloth&, std::uint32_t, solver::World<3>&, Weave&);

}  // namespace cycloid::scenes
