# Read by cpack: the page gets a package of its own if it has been built.
if(EXISTS ${CMAKE_CURRENT_LIST_DIR}/../../build/web/goingrate.html)
  list(APPEND CPACK_COMPONENTS_ALL web)
endif()
