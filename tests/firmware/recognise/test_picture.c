/* The picture of the camera's view: how a frame is drawn, which client gets it, and when it is not
 * sent. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "firmware/recognise/relief_picture.h"
#include "tests/firmware/rigs/bus_rig.h"

/* ---- drawing ---- */

/* Makes a frame of 640x400 pixels whose depth is at + right * column + down * row. */
static struct iso_frame *plane(double at_mm, double right_mm, double down_mm)
{
    const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                      .width_px = 640,
                                      .height_px = 400,
                                      .fx_px = 500,
                                      .fy_px = 500,
                                      .cx_px = 320,
                                      .cy_px = 200};
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, 640, 400, false, &frame), 0);
    for (int row = 0; row < 400; row++) {
        for (int column = 0; column < 640; column++) {
            frame->depth_mm[row * 640 + column] = (float)(at_mm + right_mm * column +
                                                          down_mm * row);
        }
    }
    return frame;
}

/* Returns the brightness in the middle of such a picture. */
static int middle(double at_mm, double right_mm, double down_mm)
{
    struct iso_image image = {.width_px = 0};
    struct iso_frame *frame = plane(at_mm, right_mm, down_mm);
    assert_int_equal(iso_relief_picture(frame, &image, NULL), 0);
    const int grey = ((const uint8_t *)image.samples)[100 * 320 + 160];
    iso_image_done(&image);
    iso_frame_free(frame);
    return grey;
}

static void a_surface_is_lit_from_the_upper_left(void **state)
{
    (void)state;
    const int flat = middle(800, 0, 0);
    /* 1 mm per pixel at 800 mm is a slope of 32 degrees. */
    assert_true(middle(480, 1, 0) < flat - 20);   /* faces right */
    assert_true(middle(1120, -1, 0) > flat + 10); /* faces left */
    assert_true(middle(600, 0, 1) < flat - 20);   /* faces down */
    assert_true(middle(1000, 0, -1) > flat + 10); /* faces up */
    assert_true(middle(1800, 0, 0) < flat - 40);  /* farther away */
    assert_true(middle(9000, 0, 0) > 20);         /* but no measured pixel is black */
}

static void unmeasured_pixels_are_black_and_stay_in_their_place(void **state)
{
    (void)state;
    struct iso_image image = {.width_px = 0};
    struct iso_frame *frame = plane(800, 0, 0);
    for (int row = 40; row < 80; row++) {
        for (int column = 500; column < 600; column++) {
            frame->depth_mm[row * 640 + column] = 0;
        }
    }
    assert_int_equal(iso_relief_picture(frame, &image, NULL), 0);
    assert_int_equal(image.width_px, 320);
    assert_int_equal(image.height_px, 200);
    const uint8_t *pixels = image.samples;
    for (int row = 0; row < 200; row++) {
        for (int column = 0; column < 320; column++) {
            const bool hole = row >= 20 && row < 40 && column >= 250 && column < 300;
            assert_int_equal(pixels[row * 320 + column] == 0, hole);
        }
    }
    iso_image_done(&image);
    iso_frame_free(frame);
}

/* ---- the file ---- */

static void read_picture(int fd, struct iso_image *image)
{
    struct iso_fault fault = {.text = ""};
    struct stat status;
    assert_int_equal(fstat(fd, &status), 0);
    assert_true(S_ISREG(status.st_mode));
    uint8_t *bytes = malloc((size_t)status.st_size);
    assert_int_equal(pread(fd, bytes, (size_t)status.st_size, 0), status.st_size);
    if (iso_png_read_memory("picture", bytes, (size_t)status.st_size, NULL, image, &fault)) {
        fail_msg("%s", fault.text);
    }
    free(bytes);
}

static void the_file_is_a_png_that_nobody_can_change(void **state)
{
    (void)state;
    struct iso_image image = {.width_px = 0};
    struct iso_frame *frame = plane(800, 0.1, 0);
    const int fd = iso_relief_picture_file(frame, NULL);
    assert_true(fd >= 0);
    read_picture(fd, &image);
    assert_int_equal(image.pixel, ISO_PIXEL_GREY8);
    assert_int_equal(image.width_px, 320);
    assert_int_equal(image.height_px, 200);
    assert_int_equal(pwrite(fd, "x", 1, 0), -1);
    assert_int_equal(ftruncate(fd, 0), -1);
    iso_image_done(&image);
    iso_frame_free(frame);
    close(fd);
}

static void a_frame_that_is_too_large_is_refused(void **state)
{
    (void)state;
    struct iso_fault fault = {.text = ""};
    const struct iso_camera camera = {
        .projection = ISO_PINHOLE, .width_px = 8192, .height_px = 2, .fx_px = 500, .fy_px = 500};
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, 8192, 2, false, &frame), 0);
    assert_int_equal(iso_relief_picture_file(frame, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "cannot be drawn"));
    iso_frame_free(frame);
}

/* ---- on the bus ---- */

struct answer {
    int n, fd;
    char error[96];
};

static int on_answer(sd_bus_message *reply, void *context, sd_bus_error *unused)
{
    struct answer *answer = context;
    const sd_bus_error *error = sd_bus_message_get_error(reply);
    int fd = -1;
    (void)unused;
    answer->n++;
    if (error) {
        const char *dot = strrchr(error->name, '.');
        (void)snprintf(answer->error, sizeof answer->error, "%s", dot ? dot + 1 : "");
    } else {
        assert_true(sd_bus_message_read(reply, "h", &fd) > 0);
        answer->fd = fcntl(fd, F_DUPFD_CLOEXEC,
                           0); /* the reply's own descriptor is closed with it */
        assert_true(answer->fd >= 0);
    }
    return 0;
}

/* Lets both ends process the messages that were sent so far. */
static void settle(struct bus_rig *f)
{
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_GET_STATUS, NULL), "");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_GET_STATUS, NULL), "");
}

/* Asks for a picture. The answer may come later. */
static void ask(struct bus_rig *f, int client, struct answer *answer)
{
    *answer = (struct answer){.fd = -1};
    sd_bus_message *call = bus_rig_new_call(f, client, ISO_CONTRACT_PICTURE);
    assert_true(sd_bus_call_async(f->client[client], NULL, call, on_answer, answer, 0) >= 0);
    sd_bus_message_unref(call);
    settle(f);
}

static void expect_error(const struct answer *answer, const char *error)
{
    assert_int_equal(answer->n, 1);
    assert_string_equal(answer->error, error);
}

static void the_claimant_gets_the_next_frame(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct answer answer;
    struct iso_image image = {.width_px = 0};
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    ask(f, 0, &answer);
    assert_int_equal(answer.n, 0);
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 200);
    assert_int_equal(answer.n, 1);
    assert_true(answer.fd >= 0);
    read_picture(answer.fd, &image);
    assert_int_equal(image.width_px, 8); /* like the frames of the puppet */
    assert_int_equal(image.height_px, 1);
    assert_non_null(strstr(rig_record(f->rig, "picture"), "\"event\":\"picture\""));
    iso_image_done(&image);
    close(answer.fd);
}

static void nobody_else_gets_one(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct answer answer;
    ask(f, 0, &answer);
    expect_error(&answer, "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
    ask(f, 0, &answer);
    expect_error(&answer, "AlreadyInUse");
    assert_string_equal(rig_record(f->rig, "picture"), "");
}

static void one_at_a_time_and_none_during_an_action(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct answer first, second;
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    ask(f, 0, &first);
    ask(f, 0, &second);
    expect_error(&second, "ActionInProgress");
    rig_show(f->rig, 50, 1);
    bus_rig_run(f, 100);
    assert_int_equal(first.n, 1);
    close(first.fd);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "");
    ask(f, 0, &second);
    expect_error(&second, "ActionInProgress");
}

/* The daemon also answers if the camera delivers no frame, and if the claim has ended. */
static void a_missing_picture_is_answered_with_a_fault(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct answer answer;
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    ask(f, 0, &answer);
    bus_rig_run(f, 2900);
    assert_int_equal(answer.n, 0);
    bus_rig_run(f, 200);
    expect_error(&answer, "DeviceFault");
    ask(f, 0, &answer);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_RELEASE, NULL), "");
    expect_error(&answer, "DeviceFault");
    rig_show(f->rig, 50, 1);
    bus_rig_run(f, 100);
    assert_int_equal(answer.n, 1); /* no second answer comes */
}

/* A client asks for a picture and leaves. The next client does not get this picture. */
static void a_client_that_leaves_the_bus_withdraws_its_request(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct answer answer;
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    ask(f, 0, &answer);
    sd_bus_flush_close_unref(f->client[0]);
    f->client[0] = NULL;
    for (int i = 0;
         i < BUS_RIG_ROUNDS && iso_appliance_status(f->rig->appliance).mode != ISO_APPLIANCE_WATCH;
         i++) {
        bus_rig_go_round(f);
    }
    f->client[0] = bus_rig_connect(f->told[0]);
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
    ask(f, 1, &answer);
    rig_show(f->rig, 50, 1);
    bus_rig_run(f, 100);
    assert_int_equal(answer.n, 1);
    assert_true(answer.fd >= 0);
    close(answer.fd);
}

/* Without a record of it, no picture is sent. */
static void without_a_record_there_is_no_picture(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct answer answer;
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    rig_fill_disk();
    ask(f, 0, &answer);
    rig_free_disk();
    assert_int_equal(answer.n, 1);
    assert_int_equal(answer.fd, -1);
    rig_show(f->rig, 50, 1);
    bus_rig_run(f, 100);
    assert_int_equal(answer.n, 1);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_surface_is_lit_from_the_upper_left),
        cmocka_unit_test(unmeasured_pixels_are_black_and_stay_in_their_place),
        cmocka_unit_test(the_file_is_a_png_that_nobody_can_change),
        cmocka_unit_test(a_frame_that_is_too_large_is_refused),
        TEST(the_claimant_gets_the_next_frame),
        TEST(nobody_else_gets_one),
        TEST(one_at_a_time_and_none_during_an_action),
        TEST(a_missing_picture_is_answered_with_a_fault),
        TEST(a_client_that_leaves_the_bus_withdraws_its_request),
        TEST(without_a_record_there_is_no_picture),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
