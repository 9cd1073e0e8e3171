/* Runs the inputs of inputs.h through both bearings and prints every field of every estimate, then
 * the statuses of wrong calls. `cargo xtask c-library --check` writes the inputs and compares the
 * output. */
#include "inputs.h"
#include "pintle_image_babbitt.h"
#include "pintle_image_plastic.h"
#include "pintle_model.h"
#include "print.h"

static pintle_model model;

/* The bits of a float, and the float of bits. */
typedef union {
    float number;
    uint32_t bits;
} word;

static void print_word(uint32_t bits)
{
    print_integer((int32_t)(bits >> 16));
    print_text(":");
    print_integer((int32_t)(bits & 0xffffu));
    print_text(" ");
}

static float number(uint32_t bits)
{
    word w;
    w.bits = bits;
    return w.number;
}

static uint32_t bits(float number)
{
    word w;
    w.number = number;
    return w.bits;
}

static int32_t run(const uint32_t input[6], pintle_estimate *estimate)
{
    if (input[0] == PUSH) {
        pintle_state state;
        state.radial_clearance_m = number(input[1]);
        state.deformation_m = number(input[2]);
        state.deformation_rate_m_s = number(input[3]);
        state.approach_speed_m_s = number(input[4]);
        state.sliding_speed_m_s = number(input[5]);
        return pintle_model_push(&model, &state, estimate);
    }
    if (input[0] == STEP) {
        pintle_sample sample;
        sample.radial_clearance_nm = input[1];
        sample.deformation_pm = (int32_t)input[2];
        sample.deformation_rate_nm_s = (int32_t)input[3];
        sample.approach_speed_nm_s = input[4];
        sample.sliding_speed_nm_s = (int32_t)input[5];
        return pintle_model_step(&model, &sample, estimate);
    }
    return pintle_model_skip(&model, estimate);
}

static int estimates(const uint32_t *image, size_t size)
{
    pintle_info info;
    if (pintle_model_init(&model, image, size) != PINTLE_OK || pintle_model_info(&model, &info) != PINTLE_OK) {
        return 1;
    }
    print_word(info.checksum);
    print_word((uint32_t)info.training_id);
    print_word((uint32_t)(info.training_id >> 32));
    print_word(bits(info.normal_force_high_n));
    print_word(bits(info.approach_speed_floor_m_s));
    print_text("\n");
    for (size_t i = 0; i < COUNT; i++) {
        pintle_estimate estimate;
        if (run(inputs[i], &estimate) != PINTLE_OK) {
            return 1;
        }
        print_word(bits(estimate.normal_force_n));
        print_word(bits(estimate.friction_force_n));
        print_word((uint32_t)estimate.normal_force_mn);
        print_word((uint32_t)estimate.friction_force_mn);
        print_word(estimate.flags);
        print_word(estimate.saturated);
        print_text("\n");
    }
    return 0;
}

static void print_status(int32_t status)
{
    print_integer(status);
    print_text("\n");
}

/* Copies an image to an address that is 1 above a multiple of 4, or to a multiple of 4. */
static unsigned char *copied(size_t offset)
{
    static uint32_t space[PINTLE_IMAGE_BABBITT_SIZE / 4 + 1];
    unsigned char *copy = (unsigned char *)space + offset;
    for (size_t i = 0; i < sizeof pintle_image_babbitt; i++) {
        copy[i] = ((const unsigned char *)pintle_image_babbitt)[i];
    }
    return copy;
}

static void wrong_calls(void)
{
    const size_t size = sizeof pintle_image_babbitt;
    pintle_estimate estimate;
    unsigned char *copy = copied(1);
    print_status(pintle_model_init(NULL, copy, size));
    print_status(pintle_model_init((pintle_model *)(void *)((char *)&model + 2), copy, size));
    print_status(pintle_model_init(&model, copy, size));
    copy = copied(0);
    print_status(pintle_image_check(copy, size - 4));
    copy[4000] = (unsigned char)(copy[4000] ^ 0x80u);
    print_status(pintle_model_init(&model, copy, size));
    print_status(pintle_model_skip(&model, &estimate));
    print_status(pintle_model_push(NULL, NULL, NULL));
}

#ifdef __arm__
/* Bytes of stack that a call takes: memory below this function's frame that no longer has its mark.
 * The frames of this program count, too. */
extern uint32_t bss_end[];
#define MARK 0x5ca1ab1eu

__attribute__((noinline)) static uint32_t *paint(void)
{
    uint32_t *top = (uint32_t *)__builtin_frame_address(0) - 32;
    for (volatile uint32_t *word = bss_end; word < top; word++) {
        *word = MARK;
    }
    return top;
}

static void print_stack(void)
{
    uint32_t *top = paint();
    uint32_t *lowest = bss_end;
    pintle_estimate estimate;
    pintle_info info;
    (void)pintle_model_init(&model, pintle_image_babbitt, sizeof pintle_image_babbitt);
    (void)run(inputs[0], &estimate);
    (void)pintle_model_info(&model, &info);
    while (lowest < top && *lowest == MARK) {
        lowest++;
    }
    print_text("stack ");
    print_integer((int32_t)((char *)__builtin_frame_address(0) - (char *)lowest));
    print_text("\n");
}
#else
static void print_stack(void)
{
}
#endif

int main(void)
{
    if (pintle_interface_version() != PINTLE_INTERFACE_VERSION || sizeof model != PINTLE_MODEL_SIZE) {
        return 1;
    }
    if (estimates(pintle_image_babbitt, sizeof pintle_image_babbitt) != 0
        || estimates(pintle_image_plastic, sizeof pintle_image_plastic) != 0) {
        return 1;
    }
    wrong_calls();
    print_text(pintle_status_text(PINTLE_OK));
    print_text("\n");
    print_stack();
    return 0;
}
