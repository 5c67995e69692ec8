# find_package(delassus [COMPONENTS models]): delassus::delassus, and delassus::models where it was installed and what it
# reads files with is found; asked for as a component, what is missing is an error.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
include(${CMAKE_CURRENT_LIST_DIR}/delassus-targets.cmake)
set(delassus_models_missing "it was not installed (DELASSUS_MODELS=OFF)")
include(${CMAKE_CURRENT_LIST_DIR}/delassus-models.cmake OPTIONAL)
if("models" IN_LIST delassus_FIND_COMPONENTS AND NOT delassus_models_FOUND)
  set(delassus_FOUND FALSE)
  set(delassus_NOT_FOUND_MESSAGE "delassus::models is left out: ${delassus_models_missing}")
endif()
