# The option ISOTHERM_OPENCV: the module `vision`, which checks faces in infrared or grey images by OpenCV. A build without OpenCV or
# without a C++ compiler leaves the module out. The search is by file names, because Debian's packages of single OpenCV libraries have no
# pkg-config file. Makes the target isotherm-opencv-vision.
option(ISOTHERM_OPENCV "Check faces in infrared or grey images by OpenCV, where it is found" ON)

if(ISOTHERM_OPENCV)
  if(CMAKE_C_COMPILER_ID STREQUAL "Clang" AND NOT CMAKE_CXX_COMPILER AND NOT DEFINED ENV{CXX})
    set(CMAKE_CXX_COMPILER clang++) # sanitizers of two compilers cannot be linked into one program
  endif()
  include(CheckLanguage)
  check_language(CXX)
  find_path(OPENCV_INCLUDE_DIR opencv2/objdetect.hpp PATH_SUFFIXES opencv4)
  find_library(OPENCV_CORE opencv_core)
  find_library(OPENCV_OBJDETECT opencv_objdetect)
  find_file(ISOTHERM_CASCADE haarcascade_frontalface_alt2.xml PATHS /usr/share/opencv4/haarcascades
    DOC "The cascade that the daemon uses if its configuration names no other")
  mark_as_advanced(OPENCV_INCLUDE_DIR OPENCV_CORE OPENCV_OBJDETECT)
endif()

if(ISOTHERM_OPENCV AND CMAKE_CXX_COMPILER AND OPENCV_INCLUDE_DIR AND OPENCV_CORE AND OPENCV_OBJDETECT)
  set(ISOTHERM_HAS_OPENCV ON)
  set(CMAKE_CXX_STANDARD 17)
  set(CMAKE_CXX_STANDARD_REQUIRED ON)
  enable_language(CXX)
  if(NOT ISOTHERM_CASCADE)
    set(cascade "")
  else()
    set(cascade "${ISOTHERM_CASCADE}")
  endif()
  add_library(isotherm-opencv-vision INTERFACE)
  target_include_directories(isotherm-opencv-vision SYSTEM INTERFACE ${OPENCV_INCLUDE_DIR})
  target_compile_definitions(isotherm-opencv-vision INTERFACE ISOTHERM_CASCADE="${cascade}")
  target_link_libraries(isotherm-opencv-vision INTERFACE ${OPENCV_OBJDETECT} ${OPENCV_CORE})
else()
  set(ISOTHERM_HAS_OPENCV OFF)
  message(STATUS "OpenCV: not used; faces are not checked in infrared or grey images")
endif()
