/*
 * pintle_model.h: contact force of a sliding bearing with clearance, estimated by two small
 * quantised networks.
 *
 * The collision network estimates the normal force from the state of the contact, the friction
 * network the friction force from the normal force and the sliding speed. Both compute in integers,
 * so every processor gives the same bits.
 *
 *     static pintle_model model;
 *     pintle_estimate estimate;
 *     int32_t status = pintle_model_init(&model, image, sizeof image);
 *     if (status == PINTLE_OK) status = pintle_model_push(&model, &state, &estimate);
 *
 * Memory. Nothing is allocated. You provide every object, and the library keeps no pointer but one:
 * a model reads its image in place. The image must stay readable and unchanged while the model is
 * used. Two models share nothing: use one for each bearing. A model may be moved or copied with
 * memcpy. The stack of a call is at most PINTLE_MODEL_STACK bytes on a Cortex-M4.
 *
 * Time. Call the model once a sample, at any constant rate: the networks see the newest
 * PINTLE_WINDOW samples. The library keeps no time.
 *
 * Threads. No function has state besides its arguments. Calls with different models may run at the
 * same time, calls with one model may not; this includes interrupts.
 *
 * Errors. Every function that can refuse a call returns a status, an int32_t: PINTLE_OK or the
 * reason. It checks for null pointers, misaligned objects, a storage without a model, and images
 * that are corrupted or of another kind. A refused call writes no output and leaves the history as
 * it was, except that a refused pintle_model_init empties the storage. It cannot check that a
 * pointer points to enough memory.
 *
 * This is not a safety function. An input outside the training range is flagged, not corrected.
 */
#ifndef PINTLE_MODEL_H
#define PINTLE_MODEL_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this interface. It grows when a declaration changes. */
#define PINTLE_INTERFACE_VERSION 1

/* Bytes of a pintle_model, which is aligned for uint64_t. */
#if UINTPTR_MAX > 0xffffffffu
#define PINTLE_MODEL_SIZE 2464
#else
#define PINTLE_MODEL_SIZE 2192
#endif
/* Most bytes of stack that a call takes on a Cortex-M4. */
#define PINTLE_MODEL_STACK 1536
/* Number of samples that an estimate depends on. */
#define PINTLE_WINDOW 8
/* Alignment of an image in bytes. */
#define PINTLE_IMAGE_ALIGNMENT 4

/* Status: the call was carried out. */
#define PINTLE_OK 0
/* A pointer is null. */
#define PINTLE_ERROR_NULL 1
/* A pointer is not aligned for its object. */
#define PINTLE_ERROR_ALIGNMENT 2
/* The storage contains no model: pintle_model_init was not called, or it refused its image. */
#define PINTLE_ERROR_NOT_LOADED 3
/* The image is refused, because ... its size is not the one that its header declares. */
#define PINTLE_ERROR_IMAGE_LENGTH 16
/* ... the first bytes are not those of a model image. */
#define PINTLE_ERROR_IMAGE_MAGIC 17
/* ... its format version is not the one that this library reads. */
#define PINTLE_ERROR_IMAGE_VERSION 18
/* ... it ends before its networks do. */
#define PINTLE_ERROR_IMAGE_TOO_SHORT 19
/* ... its CRC-32 is wrong: a bit has changed. */
#define PINTLE_ERROR_IMAGE_CRC 20
/* ... no bearing has its code. */
#define PINTLE_ERROR_IMAGE_BEARING 21
/* ... a layer has another shape than this library's (16-bit activations between the layers). */
#define PINTLE_ERROR_IMAGE_SHAPE 22
/* ... a field of its header is out of its range. */
#define PINTLE_ERROR_IMAGE_FIELD 23
/* ... a 32-bit sum of a layer could overflow. */
#define PINTLE_ERROR_IMAGE_OVERFLOW 24
/* ... a scale of a layer is out of its range. */
#define PINTLE_ERROR_IMAGE_SCALE 25
/* ... its address is not divisible by PINTLE_IMAGE_ALIGNMENT. */
#define PINTLE_ERROR_IMAGE_ALIGNMENT 26
/* ... bytes follow its last layer. */
#define PINTLE_ERROR_IMAGE_TRAILING 27

/* Flags of an estimate, to be combined with |. A flag belongs to the sample that it came with. To
 * exclude every flagged input, join the flags of the newest PINTLE_WINDOW estimates.
 *
 * The radial clearance is outside the training range. */
#define PINTLE_FLAG_OUTSIDE_CLEARANCE (1u << 0)
/* The deformation is above the training range. */
#define PINTLE_FLAG_OUTSIDE_DEFORMATION (1u << 1)
/* The ratio of rate to approach speed is outside the training range and was clipped to it, or one
 * of the two exceeds the integers of a pintle_sample. */
#define PINTLE_FLAG_OUTSIDE_RATE_RATIO (1u << 2)
/* The sliding speed is outside the training range and was clipped to it. */
#define PINTLE_FLAG_OUTSIDE_SLIDING_SPEED (1u << 3)
/* The estimated normal force is above every force of the training set. */
#define PINTLE_FLAG_OUTSIDE_FORCE (1u << 4)
/* Saturation: at least one activation was clipped at full scale. */
#define PINTLE_FLAG_SATURATED (1u << 5)
/* An input was infinite or not a number: the forces are 0 and the history restarts. */
#define PINTLE_FLAG_NON_FINITE (1u << 6)
/* Fewer than PINTLE_WINDOW samples since the start or the last reset: the forces are not yet those
 * of the networks. */
#define PINTLE_FLAG_WARMING_UP (1u << 7)
/* The sample was missing: the forces are 0 and the history restarts. */
#define PINTLE_FLAG_MISSING (1u << 8)
/* A bit of the networks' history, or of a value on the stack, has flipped since it was written. */
#define PINTLE_FLAG_CORRUPTED (1u << 9)
/* The coefficient of friction is 1 or more, which no bearing of the training set has. */
#define PINTLE_FLAG_IMPLAUSIBLE_FRICTION (1u << 10)
/* All flags that mean "outside the training range". */
#define PINTLE_FLAG_OUTSIDE_TRAINING 0x1fu

/* Storage of one model: history and tables. Its content is private. It needs no initial value. */
typedef struct pintle_model {
    uint64_t words[PINTLE_MODEL_SIZE / 8];
} pintle_model;

/* State of the contact in one sample, in SI units. */
typedef struct pintle_state {
    /* Radius of the bearing less that of the journal, m, above 0. */
    float radial_clearance_m;
    /* Journal's distance from the bearing's centre less the clearance, m. Positive: pressed in;
     * negative: width of the gap, and both forces are 0. */
    float deformation_m;
    /* Rate of the deformation, m/s; positive while the surfaces approach. */
    float deformation_rate_m_s;
    /* Rate of the deformation when this contact began, m/s, 0 or above. Keep it until the contact
     * ends. Values below the image's floor count as the floor. */
    float approach_speed_m_s;
    /* Tangential speed of the journal's surface on the bearing's, m/s, of either sign. */
    float sliding_speed_m_s;
} pintle_state;

/* The same in integers, for controllers that measure so. */
typedef struct pintle_sample {
    /* Radial clearance, nm. */
    uint32_t radial_clearance_nm;
    /* Deformation, pm. */
    int32_t deformation_pm;
    /* Rate of the deformation, nm/s. */
    int32_t deformation_rate_nm_s;
    /* Approach speed, nm/s. */
    uint32_t approach_speed_nm_s;
    /* Sliding speed, nm/s. */
    int32_t sliding_speed_nm_s;
} pintle_sample;

/* Forces of the bearing on the journal in one sample. */
typedef struct pintle_estimate {
    /* Normal force, N, never below 0; exactly 0 without contact. */
    float normal_force_n;
    /* Friction force along the sliding direction, N: its sign is opposed to the sliding speed. */
    float friction_force_n;
    /* Both forces in mN, as the networks compute them. */
    int32_t normal_force_mn;
    int32_t friction_force_mn;
    /* PINTLE_FLAG_... */
    uint32_t flags;
    /* Number of activations clipped at full scale, 0 to 65535. */
    uint32_t saturated;
} pintle_estimate;

/* Content of an image's header: its training and the ranges that it covers. */
typedef struct pintle_info {
    /* Identity of the training. */
    uint64_t training_id;
    /* CRC-32 of the image, which identifies it. */
    uint32_t checksum;
    /* Material of the bearing: 0 Babbitt, 1 plastic. */
    uint32_t bearing;
    /* Training range of the radial clearance, m. */
    float radial_clearance_low_m;
    float radial_clearance_high_m;
    /* Training range of the deformation, m, from 0. */
    float deformation_high_m;
    /* Training range of rate / approach speed, of either sign. */
    float rate_ratio_high;
    /* Training range of the sliding speed, m/s, of either sign. */
    float sliding_speed_high_m_s;
    /* Largest normal force of the training set, N. */
    float normal_force_high_n;
    /* Smallest approach speed that the networks see, m/s. */
    float approach_speed_floor_m_s;
    /* 0. */
    uint32_t reserved;
} pintle_info;

/* Version of the interface that the library was built for; compare with PINTLE_INTERFACE_VERSION. */
uint32_t pintle_interface_version(void);

/* Meaning of a status in English: a constant text, never null. */
const char *pintle_status_text(int32_t status);

/* Checks `size` bytes of an image: address, length, checksum, shapes, and that no sum can overflow.
 * It takes about as long as pintle_model_init. An image in use may be checked at any time. */
int32_t pintle_image_check(const void *image, size_t size);

/* Checks an image as pintle_image_check does and starts a model on it, with an empty history. A
 * storage may be started again at any time. */
int32_t pintle_model_init(pintle_model *model, const void *image, size_t size);

/* Estimates the forces of the next sample. An input that is infinite or not a number is flagged,
 * not refused. */
int32_t pintle_model_push(pintle_model *model, const pintle_state *state, pintle_estimate *estimate);

/* The same for a sample in integers. */
int32_t pintle_model_step(pintle_model *model, const pintle_sample *sample, pintle_estimate *estimate);

/* Records that a sample is missing: the forces are 0, and the history restarts. */
int32_t pintle_model_skip(pintle_model *model, pintle_estimate *estimate);

/* Clears the history. */
int32_t pintle_model_reset(pintle_model *model);

/* Writes the training ranges of the model's image. */
int32_t pintle_model_info(pintle_model *model, pintle_info *info);

#ifdef __cplusplus
}
#endif

#endif
