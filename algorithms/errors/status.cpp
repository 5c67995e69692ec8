#include "algorithms/errors/status.h"

namespace delassus {

ModelError::ModelError(const std::string& file, const std::string& element, const std::string& problem,
                       const std::string& accepted)
    : std::runtime_error((file.empty() ? "" : file + ": ") + (element.empty() ? "" : element + ": ") + problem +
                         (accepted.empty() ? "" : " (accepted: " + accepted + ")")) {}

}  // namespace delassus
