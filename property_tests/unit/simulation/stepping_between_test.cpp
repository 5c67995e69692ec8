// Coefficients of two bodies alone, against scenes in which they hold for all; a house of light cards.
#include <gtest/gtest.h>

#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::stepping_between_test {
namespace {

using namespace stepping;

/// A brick on the ground, far away another, and one on a fixed table; all are thrown, turn and come down by 1 mm.
std::string bricks(const std::string& contacts) {
  const auto brick = [](const std::string& name, int x, double z) {
    return "  - {name: " + name + ", mass: 1, size: [0.3, 0.2, 0.1], pose: {xyz: [" + std::to_string(x) + ", 0, " + std::to_string(z) +
           "]}, velocity: {linear: [1, 0.2, -0.5], angular: [0, 0, 3]}, friction: 0.3}\n";
  };
  return "gravity: [0, 0, -9.81]\nground: {z: 0, friction: 0.3}\nboxes:\n" + brick("a", 0, 0.051) + brick("b", 10, 0.051) + brick("c", 20, 0.551) +
         "  - {name: table, fixed: true, size: [2, 2, 0.5], pose: {xyz: [20, 0, 0.25]}, friction: 0.3}\ncontacts: {detect: true, damping: 1.0e-3" + contacts + "}\n";
}

/// Velocities of the three after 40 steps.
std::vector<VectorX<double>> ends_of(const std::string& contacts) {
  const State<double> s = run(read(bricks(contacts)), step_of(1e-3), 40);
  std::vector<VectorX<double>> out;
  for (Index k = 0; 6 * k < s.nu.size(); ++k) out.emplace_back(s.nu.segment(6 * k, 6));
  return out;
}

// Bricks are islands: each has the bits of the scene in which its coefficients are those of all.
TEST(Between, each_contact_has_its_own) {
  const auto plain = ends_of("");
  ASSERT_EQ(plain.size(), 3u);
  for (const auto& [key, value] : std::vector<std::pair<std::string, std::string>>{{"friction", "0.6"}, {"torsional_friction", "0.02"}, {"rolling_friction", "0.01"}, {"restitution", "0.4"}}) {
    const std::string given = key + ": " + value;
    const auto as_all = ends_of(", " + given);
    ASSERT_EQ(as_all.size(), 3u);
    for (const auto& [ends, brick] : std::vector<std::pair<std::string, std::size_t>>{{"of: a, to: ground", 0}, {"of: ground, to: b", 1}, {"of: b", 1}, {"of: c, to: table", 2}, {"of: table", 2}}) {
      EXPECT_NE(as_all[brick], plain[brick]) << key;
      auto expected = plain;
      expected[brick] = as_all[brick];
      EXPECT_EQ(ends_of(", between: [{" + ends + ", " + given + "}]"), expected) << ends << ", " << given;
    }
  }
}

// A later entry stands before an earlier one, coefficient by coefficient; 0 is a coefficient.
TEST(Between, later_entries_stand_before_earlier_ones) {
  const auto both = ends_of(", restitution: 0.4, between: [{of: a, friction: 0.9, rolling_friction: 0.01}, {of: a, to: ground, friction: 0.6}, {of: b, restitution: 0}]");
  ASSERT_EQ(both.size(), 3u);
  EXPECT_EQ(both[0], ends_of(", restitution: 0.4, friction: 0.6, rolling_friction: 0.01")[0]);
  EXPECT_EQ(both[1], ends_of("")[1]);
  EXPECT_EQ(both[2], ends_of(", restitution: 0.4")[2]);
}

TEST(Between, rows_at_the_pose_have_it_too) {
  const Scene s = read("ground: {z: 0, friction: 0.3}\nboxes:\n  - {name: a, mass: 1, size: [1, 1, 1], pose: {xyz: [0, 0, 0.5]}}\n  - {name: b, mass: 1, size: [1, 1, 1], pose: {xyz: [5, 0, 0.5]}}\n"
                       "contacts: {detect: true, between: [{of: b, to: ground, friction: 0.7}]}\n");
  ASSERT_EQ(s.model.constraints.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(s.model.constraints[k].friction, k < 4 ? 0.3 : 0.7);
}

TEST(Between, what_cannot_be_is_refused) {
  for (const std::string wrong : {"{of: d, friction: 1}", "{to: a, friction: 1}", "{of: a, friction: -1}", "{of: a, restitution: 2}", "{of: a, mu: 1}"})
    EXPECT_THROW((void)read(bricks(", between: [" + wrong + "]")), ModelError) << wrong;
}

/// Two storeys of cards of 2 g and 3 mm, hard contacts: drawn so that they touch.
Scene card_house() {
  const double t = 0.003, lean = 0.34906585, z = (0.3 * std::cos(lean) + t * std::sin(lean)) / 2, x = (0.3 * std::sin(lean) + t * std::cos(lean)) / 2;
  Model m;
  std::vector<std::array<double, 3>> at;
  const auto pair = [&](double apex, double height) {
    for (const double side : {-1.0, 1.0}) m.add(box("card " + std::to_string(at.size()), 0.002, {t / 2, 0.1, 0.15})), at.push_back({apex + side * x, height, -side * lean});
  };
  pair(-0.131, z), pair(0.131, z), pair(0, 3 * z + t);
  m.add(box("roof", 0.002, {0.191, 0.1, t / 2})), at.push_back({0, 2 * z + t / 2, 0});
  Scene s = on_the_ground(std::move(m), {0, 0, -9.81}, 0.8);
  s.motion.friction = 0.8;
  for (std::size_t k = 0; k < at.size(); ++k) s.q.segment<7>(7 * static_cast<Index>(k)) << at[k][0], 0, at[k][1], std::cos(at[k][2] / 2), 0, std::sin(at[k][2] / 2), 0;
  return s;
}

// The mass is no scale of the problem: 2 g stand as 0.1 kg do. What creeps is what the residual of 1e-10 m/s leaves, step by step.
TEST(Between, a_house_of_cards_of_two_grams_stands) {
  const Scene scene = card_house();
  const int n = 300;
  const State<double> end = run(scene, step_of(1e-3), n);
  ASSERT_EQ(end.q.size(), scene.q.size());
  EXPECT_LT((end.q - scene.q).cwiseAbs().maxCoeff(), n * 1e-3 * 1e-9);
  EXPECT_LT(end.nu.cwiseAbs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace delassus::stepping_between_test
