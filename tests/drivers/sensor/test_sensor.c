/* The checked wrapper of the sensor class, over a back end that the test controls. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/sensor/contract/sensor.h"
#include "tests/support/devices/manual_clock.h"

/* The answers of the back end, and the calls that it received. */
static struct puppet {
    int check_error, open_error, start_error, wait_error, stop_error;
    const char *wait_text;
    float depth_mm[6];
    struct iso_frame frame;
    int checks, starts, stops, closes;
    int64_t deadline_ns;
} puppet;

static int64_t now_ns;

static int puppet_open(const struct iso_option *options, size_t n_options,
                       const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    (void)options;
    (void)n_options;
    (void)clock;
    if (puppet.open_error) {
        return iso_fault_set(fault, puppet.open_error, "puppet: will not open");
    }
    *self = &puppet;
    return 0;
}

static int puppet_start(void *self, struct iso_fault *fault)
{
    (void)fault;
    ((struct puppet *)self)->starts++;
    return puppet.start_error;
}

static int puppet_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                       struct iso_fault *fault)
{
    struct puppet *p = self;
    p->deadline_ns = deadline_ns;
    if (p->wait_error) {
        return p->wait_text ? iso_fault_set(fault, p->wait_error, "%s", p->wait_text)
                            : p->wait_error;
    }
    *frame = &p->frame;
    return 0;
}

static int puppet_stop(void *self)
{
    ((struct puppet *)self)->stops++;
    return puppet.stop_error;
}

static void puppet_close(void *self)
{
    ((struct puppet *)self)->closes++;
}

static int puppet_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    (void)options;
    (void)n_options;
    puppet.checks++;
    return puppet.check_error ? iso_fault_set(fault, puppet.check_error, "puppet: wrong option")
                              : 0;
}

static const struct iso_sensor_ops puppet_ops = {
    .name = "puppet",
    .check = puppet_check,
    .open = puppet_open,
    .start = puppet_start,
    .wait = puppet_wait,
    .stop = puppet_stop,
    .close = puppet_close,
};

static struct iso_sensor *open_puppet(void)
{
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    now_ns = 1000;
    puppet = (struct puppet){.depth_mm = {0, 700, 701, 702, 0, 703}};
    puppet.frame = (struct iso_frame){
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = 3,
                   .height_px = 2,
                   .fx_px = 500,
                   .fy_px = 500,
                   .cx_px = 1,
                   .cy_px = 1},
        .width_px = 3,
        .height_px = 2,
        .t_ns = 900,
        .sequence = 5,
        .depth_mm = puppet.depth_mm,
    };
    assert_int_equal(iso_sensor_open_ops(&puppet_ops, NULL, 0, &clock, &sensor, NULL), 0);
    return sensor;
}

static struct iso_sensor *start_puppet(void)
{
    struct iso_sensor *sensor = open_puppet();
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    return sensor;
}

static void knows_its_back_ends(void **state)
{
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault;
    (void)state;
    assert_string_equal(iso_sensor_registered(0), "replay");
    assert_int_equal(iso_sensor_open("kinect9", NULL, 0, &clock, &sensor, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "no sensor 'kinect9'; there are: replay"));
    assert_null(sensor);
    size_t n = 0;
    while (iso_sensor_registered(n)) {
        n++;
    }
    assert_true(n >= 1);
}

static void refuses_a_back_end_with_holes(void **state)
{
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault;
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct iso_sensor_ops ops = puppet_ops;
        ops.name = i == 0 ? NULL : ops.name;
        ops.open = i == 1 ? NULL : ops.open;
        ops.start = i == 2 ? NULL : ops.start;
        ops.wait = i == 3 ? NULL : ops.wait;
        ops.stop = i == 4 ? NULL : ops.stop;
        ops.close = i == 5 ? NULL : ops.close;
        assert_int_equal(iso_sensor_open_ops(&ops, NULL, 0, &clock, &sensor, &fault), -EINVAL);
        assert_non_null(strstr(fault.text, "a required operation is missing"));
    }
    assert_null(sensor);
}

/* Options are checked before the device is opened: with a wrong option and a missing device, the
 * fault names the option. */
static void checks_options_before_it_opens(void **state)
{
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault;
    (void)state;
    puppet = (struct puppet){.check_error = -EINVAL, .open_error = -ENODEV};
    assert_int_equal(iso_sensor_open_ops(&puppet_ops, NULL, 0, &clock, &sensor, &fault), -EINVAL);
    assert_string_equal(fault.text, "puppet: wrong option");
    assert_null(sensor);
    puppet.check_error = 0;
    assert_int_equal(iso_sensor_open_ops(&puppet_ops, NULL, 0, &clock, &sensor, &fault), -ENODEV);
    assert_int_equal(puppet.checks, 2);
    puppet = (struct puppet){0};
}

/* Options that the table refuses do not reach the back end. */
static void asks_the_table_of_options_first(void **state)
{
    static const struct iso_option_spec specs[] = {
        {.name = "rate", .kind = ISO_OPTION_NUMBER, .min = 1, .max = 60, .standard = "30"},
        {.name = NULL},
    };
    const struct iso_option unknown = {"size", "3"}, bad = {"rate", "61"}, good = {"rate", "60"};
    struct iso_sensor_ops ops = puppet_ops;
    struct iso_fault fault;
    (void)state;
    puppet = (struct puppet){0};
    assert_int_equal(iso_sensor_check_ops(&ops, &good, 1, &fault), -EINVAL); /* it has no table */
    assert_string_equal(fault.text, "sensor puppet: unknown option 'rate'");
    ops.options = specs;
    assert_int_equal(iso_sensor_check_ops(&ops, &unknown, 1, &fault), -EINVAL);
    assert_string_equal(fault.text, "sensor puppet: unknown option 'size'");
    assert_int_equal(iso_sensor_check_ops(&ops, &bad, 1, &fault), -EINVAL);
    assert_string_equal(fault.text, "sensor puppet: bad value '61' for 'rate' (a number, 1 to 60)");
    assert_int_equal(puppet.checks, 0);
    assert_int_equal(iso_sensor_check_ops(&ops, &good, 1, &fault), 0);
    assert_int_equal(puppet.checks, 1);
    ops.check = NULL;
    assert_int_equal(iso_sensor_check_ops(&ops, &good, 1, &fault), 0);
    puppet = (struct puppet){0};
}

static void passes_on_why_it_does_not_open(void **state)
{
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault;
    (void)state;
    puppet.open_error = -EBUSY;
    assert_int_equal(iso_sensor_open_ops(&puppet_ops, NULL, 0, &clock, &sensor, &fault), -EBUSY);
    assert_string_equal(fault.text, "puppet: will not open");
    assert_null(sensor);
}

static void keeps_the_order_of_calls(void **state)
{
    struct iso_sensor *sensor = open_puppet();
    const struct iso_frame *frame = NULL;
    struct iso_fault fault;
    int64_t due_ns = 3;
    (void)state;
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, &fault), -EBADFD);
    assert_string_equal(fault.text, "sensor puppet: is open, not started");
    assert_int_equal(iso_sensor_stop(sensor, NULL), -EBADFD);
    assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), -EBADFD);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, &fault), -EBADFD);
    assert_string_equal(fault.text, "sensor puppet: is started, not open");
    assert_int_equal(iso_sensor_health(sensor).state, ISO_SENSOR_STARTED);
    assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
    assert_int_equal(iso_sensor_health(sensor).state, ISO_SENSOR_OPEN);
    assert_int_equal(puppet.starts, 1);
    assert_int_equal(puppet.stops, 1);
    iso_sensor_close(sensor);
    assert_int_equal(puppet.closes, 1);
}

static void closing_stops_first(void **state)
{
    (void)state;
    iso_sensor_close(start_puppet());
    assert_int_equal(puppet.stops, 1);
    assert_int_equal(puppet.closes, 1);
    iso_sensor_close(NULL);
}

static void says_what_a_back_end_lacks(void **state)
{
    struct iso_sensor *sensor = start_puppet();
    struct iso_sensor_description description;
    int64_t due_ns;
    (void)state;
    assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), -ENOSYS);
    assert_int_equal(iso_sensor_poll_fd(sensor), -ENOSYS);
    assert_int_equal(iso_sensor_describe(sensor, &description), -ENOSYS);
    assert_string_equal(iso_sensor_name(sensor), "puppet");
    iso_sensor_close(sensor);
}

static void hands_up_frames(void **state)
{
    struct iso_sensor *sensor = start_puppet();
    const struct iso_frame *frame = NULL;
    (void)state;
    assert_int_equal(iso_sensor_wait(sensor, 77, &frame, NULL), 0);
    assert_ptr_equal(frame, &puppet.frame);
    assert_int_equal(puppet.deadline_ns, 77);
    now_ns = 5000;
    puppet.frame.sequence = 9;
    puppet.frame.t_ns = 901;
    assert_int_equal(iso_sensor_wait(sensor, 78, &frame, NULL), 0);
    struct iso_sensor_health health = iso_sensor_health(sensor);
    assert_int_equal(health.frames, 2);
    assert_int_equal(health.lost, 3);
    assert_int_equal(health.last_frame_ns, 5000);
    assert_string_equal(health.last_fault, "");
    iso_sensor_close(sensor);
}

static void assert_frame_refused(struct iso_sensor *sensor, const char *expected)
{
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, &fault), -EBADMSG);
    assert_null(frame);
    assert_non_null(strstr(fault.text, expected));
    assert_string_equal(iso_sensor_health(sensor).last_fault, fault.text);
}

static void drops_inconsistent_frames(void **state)
{
    struct iso_sensor *sensor = start_puppet();
    const struct iso_frame *frame;
    (void)state;
    puppet.depth_mm[5] = -1.0F;
    assert_frame_refused(sensor, "sensor puppet: frame 5 refused: depth");
    puppet.depth_mm[5] = 703.0F;
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, NULL), 0);
    puppet.frame.t_ns++;
    assert_frame_refused(sensor, "sequence does not rise");
    puppet.frame.t_ns--;
    puppet.frame.sequence++;
    assert_frame_refused(sensor, "time does not rise");
    puppet.frame.t_ns++;
    puppet.frame.camera.fx_px = 0.0;
    assert_frame_refused(sensor, "frame 6 refused: ");
    puppet.frame.camera.fx_px = 500.0;
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, NULL), 0);
    assert_int_equal(iso_sensor_health(sensor).refused, 4);
    assert_int_equal(iso_sensor_health(sensor).faults, 0);
    /* A device may count from 0 again after another start. */
    assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    puppet.frame.sequence = 0;
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, NULL), 0);
    assert_int_equal(iso_sensor_health(sensor).lost, 0);
    iso_sensor_close(sensor);
}

static void a_time_out_is_no_fault(void **state)
{
    struct iso_sensor *sensor = start_puppet();
    struct iso_fault fault = {.text = "untouched"};
    const struct iso_frame *frame = NULL;
    (void)state;
    puppet.wait_error = -ETIMEDOUT;
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, &fault), -ETIMEDOUT);
    assert_string_equal(fault.text, "untouched");
    assert_int_equal(iso_sensor_health(sensor).faults, 0);
    iso_sensor_close(sensor);
}

static void every_fault_has_a_text(void **state)
{
    struct iso_sensor *sensor = start_puppet();
    struct iso_fault fault;
    const struct iso_frame *frame = NULL;
    (void)state;
    puppet.wait_error = -EIO;
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, &fault), -EIO);
    assert_string_equal(fault.text, "sensor puppet: Input/output error");
    puppet.wait_error = -EBADMSG;
    puppet.wait_text = "line 3 garbled";
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, &fault), -EBADMSG);
    assert_string_equal(fault.text, "line 3 garbled");
    assert_int_equal(iso_sensor_health(sensor).faults, 2);
    puppet.stop_error = -EIO;
    assert_int_equal(iso_sensor_stop(sensor, &fault), -EIO);
    assert_int_equal(iso_sensor_health(sensor).state, ISO_SENSOR_OPEN);
    iso_sensor_close(sensor);
}

static void a_lost_device_can_only_be_closed(void **state)
{
    struct iso_sensor *sensor = start_puppet();
    struct iso_fault fault;
    const struct iso_frame *frame = NULL;
    int64_t due_ns;
    (void)state;
    puppet.wait_error = -ENODEV;
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, NULL), -ENODEV);
    assert_int_equal(iso_sensor_health(sensor).state, ISO_SENSOR_LOST);
    assert_string_equal(iso_sensor_state_name(ISO_SENSOR_LOST), "lost");
    puppet.wait_error = 0;
    assert_int_equal(iso_sensor_wait(sensor, 0, &frame, &fault), -ENODEV);
    assert_string_equal(fault.text, "sensor puppet: the device is gone");
    assert_int_equal(iso_sensor_start(sensor, NULL), -ENODEV);
    assert_int_equal(iso_sensor_stop(sensor, NULL), -ENODEV);
    assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), -ENODEV);
    iso_sensor_close(sensor);
    assert_int_equal(puppet.stops, 0);
    assert_int_equal(puppet.closes, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knows_its_back_ends),
        cmocka_unit_test(refuses_a_back_end_with_holes),
        cmocka_unit_test(checks_options_before_it_opens),
        cmocka_unit_test(asks_the_table_of_options_first),
        cmocka_unit_test(passes_on_why_it_does_not_open),
        cmocka_unit_test(keeps_the_order_of_calls),
        cmocka_unit_test(closing_stops_first),
        cmocka_unit_test(says_what_a_back_end_lacks),
        cmocka_unit_test(hands_up_frames),
        cmocka_unit_test(drops_inconsistent_frames),
        cmocka_unit_test(a_time_out_is_no_fault),
        cmocka_unit_test(every_fault_has_a_text),
        cmocka_unit_test(a_lost_device_can_only_be_closed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
