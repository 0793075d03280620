# Finds OpenImageIO by its headers and libraries. Debian's own config file names files that Debian does not install.
# Defines OpenImageIO::OpenImageIO.
find_path(OpenImageIO_INCLUDE_DIR OpenImageIO/imageio.h)
find_path(Imath_INCLUDE_DIR half.h PATH_SUFFIXES Imath)
find_library(OpenImageIO_LIBRARY OpenImageIO)
find_library(OpenImageIO_UTIL_LIBRARY OpenImageIO_Util)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO
    REQUIRED_VARS OpenImageIO_LIBRARY OpenImageIO_UTIL_LIBRARY OpenImageIO_INCLUDE_DIR Imath_INCLUDE_DIR)
if(OpenImageIO_FOUND AND NOT TARGET OpenImageIO::OpenImageIO)
    add_library(OpenImageIO::OpenImageIO INTERFACE IMPORTED)
    set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
        INTERFACE_INCLUDE_DIRECTORIES "${OpenImageIO_INCLUDE_DIR};${Imath_INCLUDE_DIR}"
        INTERFACE_LINK_LIBRARIES "${OpenImageIO_LIBRARY};${OpenImageIO_UTIL_LIBRARY}")
endif()
mark_as_advanced(OpenImageIO_INCLUDE_DIR Imath_INCLUDE_DIR OpenImageIO_LIBRARY OpenImageIO_UTIL_LIBRARY)
