/* Model image of the @NAME@ bearing and the ranges that its networks were trained for. Outside of
 * them an estimate is flagged. Written by `model-quant generate c`; do not edit. */
#ifndef PINTLE_IMAGE_@UPPER@_H
#define PINTLE_IMAGE_@UPPER@_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of the image. */
#define PINTLE_IMAGE_@UPPER@_SIZE @SIZE@
/* CRC-32 of the image, which identifies it: pintle_info.checksum. */
#define PINTLE_@UPPER@_CHECKSUM @CHECKSUM@u
/* Radial clearance, m. */
#define PINTLE_@UPPER@_RADIAL_CLEARANCE_LOW_M @CLEARANCE_LOW@f
#define PINTLE_@UPPER@_RADIAL_CLEARANCE_HIGH_M @CLEARANCE_HIGH@f
/* Deformation, m, from 0. */
#define PINTLE_@UPPER@_DEFORMATION_HIGH_M @DEFORMATION@f
/* Rate of the deformation over the approach speed, of either sign. */
#define PINTLE_@UPPER@_RATE_RATIO_HIGH @RATIO@f
/* Sliding speed, m/s, of either sign. */
#define PINTLE_@UPPER@_SLIDING_SPEED_HIGH_M_S @SLIDING@f
/* Largest normal force of the training set, N. */
#define PINTLE_@UPPER@_NORMAL_FORCE_HIGH_N @FORCE@f
/* Smallest approach speed that the networks see, m/s. */
#define PINTLE_@UPPER@_APPROACH_SPEED_FLOOR_M_S @FLOOR@f

/* The image, for pintle_model_init(&model, pintle_image_@NAME@, sizeof pintle_image_@NAME@). */
extern const uint32_t pintle_image_@NAME@[PINTLE_IMAGE_@UPPER@_SIZE / 4];

#ifdef __cplusplus
}
#endif

#endif
