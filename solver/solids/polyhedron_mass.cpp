#include "solver/solids/polyhedron_mass.hpp"

namespace cycloid::solver {

/// Adds density times the integral of x x^T over the tetrahedron (origin, a, b, c).
static void add_products(float mass, const Vec<3>& a, const Vec<3>& b, const Vec<3>& c,
                         Inertia<3>& products) {
  const Vec<3> sum = a + b + c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      products.m[i * 3 + j] +=
          mass / 20.0f * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]);
}

MassProperties<3> mass_of(const PolyhedronView& hull, float density) {
  MassProperties<3> properties;
  Inertia<3> products{};
  for (const PolyhedronFace& face : hull.faces) {
    const Vec<3> a = hull.vertices[hull.edges[face.edge].origin].position;
    std::uint32_t edge = hull.edges[face.edge].next;
    for (std::uint32_t next = hull.edges[edge].next; next != face.edge;
         edge = next, next = hull.edges[edge].next) {
      const Vec<3> b = hull.vertices[hull.edges[edge].origin].position;
      const Vec<3> c = hull.vertices[hull.edges[next].origin].position;
      const float mass = density / 6.0f * dot(a, cross(b, c));
      properties.mass += mass;
      properties.first += (0.25f * mass) * (a + b + c);
      add_products(mass, a, b, c, products);
    }
  }
  const float trace = products.m[0] + products.m[4] + products.m[8];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      properties.second.m[i * 3 + j] = (i == j ? trace : 0.0f) - products.m[i * 3 + j];
  return properties;
}

}  // namespace cycloid::solver
