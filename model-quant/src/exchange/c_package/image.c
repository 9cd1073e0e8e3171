/* Model image of the @NAME@ bearing: the bytes of a .pintle file as words, lowest byte first.
 * Written by `model-quant generate c`; do not edit. */
#include "pintle_image_@NAME@.h"

const uint32_t pintle_image_@NAME@[PINTLE_IMAGE_@UPPER@_SIZE / 4] = {
@WORDS@};
