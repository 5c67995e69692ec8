// The mechanisms of the symbolic reference. Angles of a chain are relative; planar ones move in z = 0 about z.
#include "reference/lagrangian_sketch.h"

namespace delassus::reference::lagrangian {
namespace {

using GiNaC::ex;
using GiNaC::matrix;

/// The point at distance d along the x axis turned by the angle.
matrix along(const matrix& from, const ex& angle, const ex& d) {
  return from.add(point(d * cos(angle), d * sin(angle), 0));
}

matrix minus(const matrix& a) { return a.mul_scalar(-1); }

Mechanism pendulum() {
  Sketch s("pendulum", "One body turning about z through the world's origin, its centre of mass on its x axis.");
  const ex m = s.mass("m", "the body"), c = s.length("c", "distance of its centre of mass from the pivot"),
           d = s.length("d", "distance of the tip from the pivot"), I = s.inertia("I", "inertia about its centre of mass");
  const ex q = s.coordinate("q", "angle from the world's x axis", "rad", "A");
  const matrix origin = point(0, 0, 0);
  s.planar_body(m, along(origin, q, c), q, I);
  s.rows("tip to a point of the world, in body axes", along(origin, q, d), about_z(q));
  s.row("joint row", q);
  s.show("Rows: y of the tip, then the joint.", {1, 3});
  return s.take();
}

Mechanism cart_pole() {
  Sketch s("cart_pole", "A cart along x and a pole turning about z on it; at q = 0 the pole stands up along y.");
  const ex M = s.mass("mc", "the cart"), m = s.mass("mp", "the pole"),
           c = s.length("c", "distance of the pole's centre of mass from its pivot"),
           d = s.length("d", "distance of the pole's tip from its pivot"),
           I = s.inertia("I", "inertia of the pole about its centre of mass");
  const ex x = s.coordinate("x", "position of the cart", "m", "A1"), q = s.coordinate("q", "angle of the pole", "rad", "A2");
  const matrix cart = point(x, 0, 0);
  s.body(M, cart, identity(), matrix{{I, 0, 0}, {0, I, 0}, {0, 0, I}});
  s.planar_body(m, placed(cart, about_z(q), point(0, c, 0)), q, I);
  // Frame a is in the world: rows are minus the motion of the tip, normal y first, then z, x.
  s.rows("contact of the tip with the world: normal y, tangents z, x", minus(placed(cart, about_z(q), point(0, d, 0))),
         matrix{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}});
  s.row("joint row of the cart", x);
  s.show("Rows: tip along y and along x (world minus tip), the cart's joint. Armatures left out.", {0, 2, 3},
         {{s.armature(0), 0}, {s.armature(1), 0}});
  return s.take();
}

Mechanism double_pendulum() {
  Sketch s("double_pendulum", "Two bodies in a chain about z; centres of mass on their x axes.");
  const ex m1 = s.mass("m1", "body 1"), m2 = s.mass("m2", "body 2"),
           c1 = s.length("c1", "distance of centre of mass 1 from pivot 1"),
           c2 = s.length("c2", "distance of centre of mass 2 from pivot 2"),
           l1 = s.length("l1", "distance of pivot 2 from pivot 1"), l2 = s.length("l2", "distance of the tip from pivot 2"),
           I1 = s.inertia("I1", "inertia of body 1 about its centre of mass"),
           I2 = s.inertia("I2", "inertia of body 2 about its centre of mass");
  const ex q1 = s.coordinate("q1", "angle of body 1", "rad", "A1"),
           q2 = s.coordinate("q2", "angle of body 2 in body 1", "rad", "A2");
  const matrix origin = point(0, 0, 0), elbow = along(origin, q1, l1);
  s.planar_body(m1, along(origin, q1, c1), q1, I1);
  s.planar_body(m2, along(elbow, q1 + q2, c2), q1 + q2, I2);
  s.rows("tip to a point of the world, in axes of body 2", along(elbow, q1 + q2, l2), about_z(q1 + q2));
  s.show("Armatures left out. Rows: x and y of the tip in the axes of body 2.", {0, 1},
         {{s.armature(0), 0}, {s.armature(1), 0}});
  return s.take();
}

/// Values of n equal uniform rods: mass m, length l, centre in the middle, inertia m l²/12, no armature.
struct Rods {
  GiNaC::exmap values;
  GiNaC::symbol m{"m"}, l{"l"};
  void rod(const ex& mass, const ex& centre, const ex& length, const ex& inertia, const ex& armature, const ex& size = 1) {
    values[mass] = size * m;
    values[centre] = size * l / 2;
    values[length] = size * l;
    values[inertia] = size * size * size * m * l * l / 12;
    values[armature] = 0;
  }
  [[nodiscard]] std::vector<Parameter> added() const {
    return {{m, "mass of a rod of length l", "kg", 0.5, 2}, {l, "length of a rod", "m", 0.25, 1}};
  }
};

Mechanism planar_arm() {
  Sketch s("planar_arm", "Three bodies in a chain about z; the last one welded to the world, the first and last geared. "
                         "With its tip held by a point it is a four-bar linkage cut at the ground.");
  std::vector<ex> m, c, l, I, angle;
  for (int k = 1; k <= 3; ++k) {
    const std::string i = std::to_string(k);
    m.push_back(s.mass("m" + i, "body " + i));
    c.push_back(s.length("c" + i, "distance of centre of mass " + i + " from its pivot"));
    l.push_back(s.length("l" + i, "length of body " + i));
    I.push_back(s.inertia("I" + i, "inertia of body " + i + " about its centre of mass"));
    angle.push_back(s.coordinate("q" + i, "angle of body " + i + " in the one before", "rad", "A" + i));
  }
  const ex k = s.parameter("k", "gear ratio", "", 0.5, 2);
  matrix at = point(0, 0, 0);
  ex turned = 0;
  Rods rods;
  for (std::size_t i = 0; i < 3; ++i) {
    turned += angle[i];
    s.planar_body(m[i], along(at, turned, c[i]), turned, I[i]);
    at = along(at, turned, l[i]);
    rods.rod(m[i], c[i], l[i], I[i], s.armature(i));
  }
  s.rows("weld of the tip to the world, angular", point(0, 0, turned), about_z(turned));
  s.rows("weld of the tip to the world, linear, in body axes", at, about_z(turned));
  s.row("gear: q1 + k q3", angle[0] + k * angle[2]);
  s.show("Three equal uniform rods, no armature. Rows: x and y of the tip in the axes of "
         "body 3.", {3, 4}, rods.values, rods.added());
  return s.take();
}

Mechanism spherical_pendulum() {
  Sketch s("spherical_pendulum", "One body on a ball joint at the world's origin, its centre of mass on its z axis.");
  const ex m = s.mass("m", "the body"), c = s.length("c", "distance of its centre of mass below the pivot"),
           d = s.length("d", "distance of the tip below the pivot"), I1 = s.inertia("I1", "inertia about x through its centre of mass"),
           I2 = s.inertia("I2", "inertia about y"), I3 = s.inertia("I3", "inertia about z"),
           hx = s.parameter("hx", "anchor of the distance, x", "m", 2, 3), hy = s.parameter("hy", "anchor, y", "m", -1, 1),
           hz = s.parameter("hz", "anchor, z", "m", -1, 1);
  const matrix R = s.quaternion("q"), origin = point(0, 0, 0), tip = placed(origin, R, point(0, 0, -d));
  s.body(m, placed(origin, R, point(0, 0, -c)), R, matrix{{I1, 0, 0}, {0, I2, 0}, {0, 0, I3}});
  s.rows("tip to a point of the world, in body axes", tip, R);
  const matrix gap = tip.sub(point(hx, hy, hz));
  s.row("distance of the tip from the anchor",
        GiNaC::sqrt(gap(0, 0) * gap(0, 0) + gap(1, 0) * gap(1, 0) + gap(2, 0) * gap(2, 0)));
  s.show("ν = ω in body axes. Rows: x and y of the tip in body axes.", {0, 1});
  return s.take();
}

Mechanism four_bar() {
  Sketch s("four_bar", "Crank and coupler in a chain about z from the origin, rocker about z from (g, 0); the loop is "
                       "closed by a point between the ends of coupler and rocker, in the axes of the coupler.");
  const ex m1 = s.mass("m1", "the crank"), m2 = s.mass("m2", "the coupler"), m3 = s.mass("m3", "the rocker"),
           c1 = s.length("c1", "distance of the crank's centre of mass from its pivot"),
           c2 = s.length("c2", "distance of the coupler's centre of mass from the crank's end"),
           c3 = s.length("c3", "distance of the rocker's centre of mass from its pivot"),
           l1 = s.parameter("l1", "length of the crank", "m", 0.25, 0.375),
           l2 = s.parameter("l2", "length of the coupler", "m", 1, 1.25),
           l3 = s.parameter("l3", "length of the rocker", "m", 0.75, 1),
           g = s.parameter("g", "distance of the pivots on the ground", "m", 1, 1.125),
           I1 = s.inertia("I1", "inertia of the crank about its centre of mass"), I2 = s.inertia("I2", "inertia of the coupler"),
           I3 = s.inertia("I3", "inertia of the rocker");
  const ex q1 = s.coordinate("q1", "angle of the crank", "rad", "A1"),
           q2 = s.coordinate("q2", "angle of the coupler in the crank", "rad", "A2"),
           q3 = s.coordinate("q3", "angle of the rocker", "rad", "A3");
  const matrix origin = point(0, 0, 0), pivot = point(g, 0, 0), elbow = along(origin, q1, l1);
  s.planar_body(m1, along(origin, q1, c1), q1, I1);
  s.planar_body(m2, along(elbow, q1 + q2, c2), q1 + q2, I2);
  s.planar_body(m3, along(pivot, q3, c3), q3, I3);
  s.rows("end of the coupler to end of the rocker, in the axes of the coupler",
         along(elbow, q1 + q2, l2).sub(along(pivot, q3, l3)), about_z(q1 + q2));
  Rods rods;
  rods.rod(m1, c1, l1, I1, s.armature(0));
  rods.rod(m2, c2, l2, I2, s.armature(1), 3);
  rods.rod(m3, c3, l3, I3, s.armature(2), 2);
  s.show("Uniform rods of one section: crank of length l, coupler three times, rocker twice as long; "
         "no armature. Rows: x and y.", {0, 1}, rods.values, rods.added());
  return s.take();
}

Mechanism slider_crank() {
  Sketch s("slider_crank", "Crank and rod in a chain about z, slider along x; the loop is closed by a point between "
                           "slider and rod (slider minus rod, world axes).");
  const ex m1 = s.mass("m1", "the crank"), m2 = s.mass("m2", "the rod"), m3 = s.mass("m3", "the slider"),
           c1 = s.length("c1", "distance of the crank's centre of mass from its pivot"),
           c2 = s.length("c2", "distance of the rod's centre of mass from the crank's end"),
           l1 = s.parameter("l1", "length of the crank", "m", 0.25, 0.5),
           l2 = s.parameter("l2", "length of the rod", "m", 0.75, 1.5),
           I1 = s.inertia("I1", "inertia of the crank about its centre of mass"), I2 = s.inertia("I2", "inertia of the rod");
  const ex q1 = s.coordinate("q1", "angle of the crank", "rad", "A1"),
           q2 = s.coordinate("q2", "angle of the rod in the crank", "rad", "A2"),
           x = s.coordinate("x", "position of the slider", "m", "A3");
  const matrix origin = point(0, 0, 0), elbow = along(origin, q1, l1), slider = point(x, 0, 0);
  s.planar_body(m1, along(origin, q1, c1), q1, I1);
  s.planar_body(m2, along(elbow, q1 + q2, c2), q1 + q2, I2);
  s.body(m3, slider, identity(), matrix{{I1, 0, 0}, {0, I1, 0}, {0, 0, I1}});
  s.rows("slider to end of the rod, in world axes", slider.sub(along(elbow, q1 + q2, l2)), identity());
  Rods rods;
  rods.rod(m1, c1, l1, I1, s.armature(0));
  rods.rod(m2, c2, l2, I2, s.armature(1), 2);
  rods.values[s.armature(2)] = 0;
  s.show("Uniform rods of one section, the second twice as long as the crank of length l; no armature. Rows: x and y.",
         {0, 1}, rods.values, rods.added());
  return s.take();
}

Mechanism free_body() {
  Sketch s("free_body", "A free body with two contacts; its centre of mass stands apart from the origin of its frame.");
  const ex m = s.mass("m", "the body");
  const auto moment = [&](const std::string& name, const std::string& meaning) {
    return s.parameter(name, meaning, "kg m²", 0.15625, 0.1875);
  };
  const ex Ix = moment("Ixx", "inertia about the centre of mass, body axes"), Iy = moment("Iyy", "the same"),
           Iz = moment("Izz", "the same");
  const auto small = [&](const std::string& name, const std::string& meaning, const std::string& unit, double size) {
    return s.parameter(name, meaning, unit, -size, size);
  };
  const ex Ixy = small("Ixy", "entries of the inertia matrix", "kg m²", 0.015625), Ixz = small("Ixz", "the same", "kg m²", 0.015625),
           Iyz = small("Iyz", "the same", "kg m²", 0.015625);
  const ex cx = small("cx", "centre of mass in the body frame", "m", 1), cy = small("cy", "the same", "m", 1),
           cz = small("cz", "the same", "m", 1);
  const ex ax = small("ax", "first contact point in the body frame", "m", 1), ay = small("ay", "the same", "m", 1),
           az = small("az", "the same", "m", 1);
  const ex bx = small("bx", "second contact point in the body frame", "m", 1), by = small("by", "the same", "m", 1),
           bz = small("bz", "the same", "m", 1);
  // The order of q here: quaternion, position.
  const matrix R = s.quaternion("q");
  const matrix p = s.moving_point("p", R);
  s.body(m, placed(p, R, point(cx, cy, cz)), R, matrix{{Ix, Ixy, Ixz}, {Ixy, Iy, Iyz}, {Ixz, Iyz, Iz}});
  const matrix normal_first{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  s.rows("contact at the first point, in body axes, z first", placed(p, R, point(ax, ay, az)), R.mul(normal_first));
  s.rows("contact at the second point, in world axes, z first, world minus body", minus(placed(p, R, point(bx, by, bz))),
         normal_first);
  const GiNaC::exmap centred{{cx, 0}, {cy, 0}, {cz, 0}, {Ixy, 0}, {Ixz, 0}, {Iyz, 0}};
  s.show("ν = (ω, v of the origin) in body axes. Centre of mass at the origin, principal axes. Rows: first contact: normal "
         "z, tangents x, y.", {0, 1, 2}, centred);
  return s.take();
}

}  // namespace

const std::vector<Mechanism>& mechanisms() {
  static const std::vector<Mechanism> all{pendulum(),           cart_pole(), double_pendulum(), planar_arm(),
                                          spherical_pendulum(), four_bar(),  slider_crank(),    free_body()};
  return all;
}

}  // namespace delassus::reference::lagrangian
