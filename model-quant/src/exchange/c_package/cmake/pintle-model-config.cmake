# CMake package of the contact networks.
#
#   find_package(pintle-model CONFIG REQUIRED)
#   target_link_libraries(program PRIVATE pintle::@NAME@)   # the library and the image of a bearing
#
# Targets: pintle::model, the library of the platform that CMake builds for; pintle::BEARING, the
# same with the image of a bearing; pintle::model-PLATFORM, each library by its name. The variable
# PINTLE_MODEL_PLATFORM selects a library where the platform is not recognised.

get_filename_component(_pintle_root "${CMAKE_CURRENT_LIST_DIR}/.." ABSOLUTE)

get_property(_pintle_languages GLOBAL PROPERTY ENABLED_LANGUAGES)
if(NOT "C" IN_LIST _pintle_languages)
  set(pintle-model_FOUND FALSE)
  set(pintle-model_NOT_FOUND_MESSAGE "the images are C files: project(... LANGUAGES C CXX)")
  return()
endif()

if(NOT DEFINED PINTLE_MODEL_PLATFORM)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    set(PINTLE_MODEL_PLATFORM "${CMAKE_SYSTEM_PROCESSOR}-unknown-linux-gnu")
  elseif(CMAKE_SYSTEM_NAME STREQUAL "Generic" AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(arm|cortex-m[47])")
    set(PINTLE_MODEL_PLATFORM "thumbv7em-none-eabihf")
  else()
    set(PINTLE_MODEL_PLATFORM "${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}")
  endif()
endif()

set(_pintle_platforms @LIBRARIES@)
if(NOT PINTLE_MODEL_PLATFORM IN_LIST _pintle_platforms)
  set(pintle-model_FOUND FALSE)
  set(pintle-model_NOT_FOUND_MESSAGE
    "found platform ${PINTLE_MODEL_PLATFORM}; expected one of ${_pintle_platforms}: set PINTLE_MODEL_PLATFORM")
  return()
endif()

foreach(_pintle_platform IN LISTS _pintle_platforms)
  if(NOT TARGET pintle::model-${_pintle_platform})
    add_library(pintle::model-${_pintle_platform} STATIC IMPORTED)
    set_target_properties(pintle::model-${_pintle_platform} PROPERTIES
      IMPORTED_LOCATION "${_pintle_root}/lib/${_pintle_platform}/libpintle_model.a"
      INTERFACE_INCLUDE_DIRECTORIES "${_pintle_root}/include")
  endif()
endforeach()

if(NOT TARGET pintle::model)
  add_library(pintle::model INTERFACE IMPORTED)
  set_target_properties(pintle::model PROPERTIES
    INTERFACE_LINK_LIBRARIES "pintle::model-${PINTLE_MODEL_PLATFORM}")
endif()

foreach(_pintle_bearing IN ITEMS @BEARINGS@)
  if(NOT TARGET pintle::${_pintle_bearing})
    add_library(pintle::${_pintle_bearing} INTERFACE IMPORTED)
    set_target_properties(pintle::${_pintle_bearing} PROPERTIES
      INTERFACE_SOURCES "${_pintle_root}/src/pintle_image_${_pintle_bearing}.c"
      INTERFACE_LINK_LIBRARIES "pintle::model")
  endif()
endforeach()
