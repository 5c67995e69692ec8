#include "models/robot_bodies.h"

#include <utility>

#include "algorithms/errors/message.h"

namespace delassus {

Index RobotBodies::add(const std::string& link, Index parent, Joint joint, int line) {
  Body body;
  body.name = options_.robot + "/" + link;
  body.parent = parent;
  body.joint = std::move(joint);
  bodies_.push_back(std::move(body));
  parts_.emplace_back();
  lines_.push_back(line);
  return first_ + static_cast<Index>(bodies_.size()) - 1;
}

void RobotBodies::place(const std::string& link, const Frame& at, const std::vector<Shape>& shapes, const std::vector<Robot::Mesh>& meshes,
                        Robot& out) {
  out.links[link] = at;
  const std::string name = options_.robot + "/" + link;
  for (Shape s : shapes) {
    s.placement = at.placement * s.placement;
    if (at.body == ground) out.standing.push_back({name, std::move(s)});
    else body(at.body).shapes.push_back(std::move(s));
  }
  for (Robot::Mesh m : meshes) {
    m.body = at.body;
    m.link = name;
    m.placement = at.placement * m.placement;
    out.meshes.push_back(std::move(m));
  }
}

void RobotBodies::sum() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) sum_parts(parts_[i], bodies_[i]);
}

void RobotBodies::add_to(Model& model, Robot& out) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    const std::string name = std::exchange(body.name, body.name + in_line(lines_[i]));  // as messages say it
    validate_body(body, options_.file);
    body.name = name;
    out.bodies.push_back(model.add(std::move(body)));
    out.lines.push_back(lines_[i]);
  }
}

}  // namespace delassus
