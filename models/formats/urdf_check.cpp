#include "models/formats/urdf_check.h"

#include <algorithm>
#include <set>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"

namespace delassus {
namespace {

using tinyxml2::XMLElement;

/// What is accepted where a link is asked for, with the one that was probably meant.
std::string links_of(const CheckedUrdf& urdf, const std::string& text) {
  std::vector<std::string_view> names;
  for (const auto& [name, link] : urdf.links) names.push_back(name);
  return did_you_mean(text, names) + "a link of this file; add <link name=" + in_quotes(text) + "/>, or correct the name";
}

/// Every joint joins two links of the file, and no link has two parents.
std::map<std::string, const CheckedUrdf::JointRow*> parents_of(CheckedUrdf& out) {
  std::map<std::string, const CheckedUrdf::JointRow*> parent_joint;
  for (std::size_t j = 0; j < out.joints.size(); ++j) {
    const CheckedUrdf::JointRow& row = out.joints[j];
    for (const std::string* link : {&row.parent, &row.child})
      if (!out.links.count(*link)) throw ModelError(out.file, row.place, "link " + in_quotes(*link) + " does not exist", links_of(out, *link));
    if (row.parent == row.child) throw ModelError(out.file, row.place, "joins link " + in_quotes(row.parent) + " to itself", "two different links; take the joint out");
    const auto [it, first] = parent_joint.emplace(row.child, &row);
    if (!first)
      throw ModelError(out.file, row.place, "link " + in_quotes(row.child) + " already has the parent joint " + in_quotes(it->second->name),
                       "one joint per child; take one out and close the loop with a constraint of the scene");
    out.children[row.parent].push_back(static_cast<Index>(j));
  }
  return parent_joint;
}

/// One root, one parent per link, no cycle.
void check_tree(CheckedUrdf& out) {
  const auto parent_joint = parents_of(out);
  for (const auto& [name, link] : out.links) {
    if (parent_joint.count(name)) continue;
    if (!out.root.empty())
      throw ModelError(out.file, "link " + in_quotes(name) + " (line " + std::to_string(link.line) + ")",
                       "is a second root besides link " + in_quotes(out.root), "one link without a parent; join the two by a fixed joint, or write two files");
    out.root = name;
  }
  if (out.root.empty()) throw ModelError(out.file, out.joints.front().place, "every link has a parent: the joints form a cycle", "a tree; take one joint out and close the loop with a constraint of the scene");
  std::size_t reached = 0;
  std::set<std::string_view> found{out.root};
  std::vector<const std::string*> stack{&out.root};
  for (; !stack.empty(); ++reached) {
    const auto it = out.children.find(*stack.back());
    stack.pop_back();
    if (it != out.children.end())
      for (const Index j : it->second) stack.push_back(&out.joints[static_cast<std::size_t>(j)].child), found.insert(*stack.back());
  }
  if (reached == out.links.size()) return;
  const auto apart = std::find_if(out.joints.begin(), out.joints.end(), [&](const auto& j) { return !found.count(j.child); });
  throw ModelError(out.file, apart->place, "some joints form a cycle apart from the root, this one among them",
                   "a tree; take one joint of the cycle out and close the loop with a constraint of the scene");
}

/// urdfdom sees no collisions.
void strip_collisions(XMLElement& robot) {
  robot.DeleteAttribute("version");
  for (XMLElement* link = robot.FirstChildElement("link"); link; link = link->NextSiblingElement("link"))
    while (XMLElement* c = link->FirstChildElement("collision")) link->DeleteChild(c);
}

/// Links, joints and their tree.
CheckedUrdf read_elements(const std::string& file, XMLElement& robot, Findings& findings) {
  CheckedUrdf out;
  out.file = file;
  std::set<std::string> joint_names;
  int meshes = 0;
  Tally tally;
  for (XMLElement* e = robot.FirstChildElement(); e; e = e->NextSiblingElement()) {
    if (std::string_view(e->Name()) == "link") check_link(file, *e, out, findings, tally, meshes);
    if (std::string_view(e->Name()) != "joint") continue;
    out.joints.push_back(joint_row(file, *e, findings, tally));
    if (!joint_names.insert(out.joints.back().name).second)
      Place{file, "joint " + in_quotes(out.joints.back().name)}.fail(*e, "the name is taken", "unique joint names; rename one of the two");
  }
  if (out.links.empty()) throw ModelError(file, "<robot> (line " + std::to_string(robot.GetLineNum()) + ")", "has no link", "at least one link; a file of macros is expanded by xacro first");
  check_tree(out);
  tally.report(file, findings);
  if (meshes > 0) findings.note(file + ": " + std::to_string(meshes) + " collision meshes, read only where contacts are detected");
  return out;
}

}  // namespace

CheckedUrdf check_urdf(const std::string& file, Findings& findings) {
  tinyxml2::XMLDocument document;
  XMLElement& robot = load_xml(document, file);
  if (std::string_view(robot.Name()) != "robot")
    throw ModelError(file, "root element" + in_line(robot.GetLineNum()), in_quotes(robot.Name()) + " is no robot", "<robot name=\"...\">; convert the file to URDF");
  if (robot.Attribute("name") == nullptr || *robot.Attribute("name") == '\0') {  // urdfdom insists; nothing depends on it
    findings.note(file + ": <robot> has no name");
    robot.SetAttribute("name", "robot");
  }
  leave_out(file, robot, findings);
  const bool xacro = std::any_of(findings.warnings.begin(), findings.warnings.end(), [](const Warning& w) { return w.kind == "unexpanded xacro"; });
  CheckedUrdf out;
  try {
    out = read_elements(file, robot, findings);
  } catch (const ModelError& e) {
    if (!xacro) throw;
    throw ModelError(std::string(e.what()) + "; the file holds unexpanded xacro: run xacro first");
  }
  strip_collisions(robot);
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  out.text = printer.CStr();
  return out;
}

}  // namespace delassus
