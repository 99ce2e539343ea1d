/* The stages of a rollout, without a database. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "enroll/hub/update/rollout_stage.h"

static struct hub_rollout_stage running(void)
{
    return (struct hub_rollout_stage){
        .state = HUB_ROLLOUT_RUNNING, .stage = 1, .most = 3, .stop_after = 1, .wait_s = 60};
}

static void a_stage_waits_for_its_doors(void **state)
{
    struct hub_rollout_stage stage = running();
    struct hub_rollout_count count = {.told = 2, .finished = 2, .waiting = 20, .finished_s = 1000};
    (void)state;
    /* It is not full. */
    hub_rollout_move(&stage, &count, 5000);
    assert_int_equal(stage.stage, 1);
    /* One of it has not finished. */
    count.told = 3;
    hub_rollout_move(&stage, &count, 5000);
    assert_int_equal(stage.stage, 1);
    /* The time to wait is not over. */
    count.finished = 3;
    hub_rollout_move(&stage, &count, 1059);
    assert_int_equal(stage.stage, 1);
    hub_rollout_move(&stage, &count, 1060);
    assert_int_equal(stage.stage, 2);
    assert_int_equal(stage.most, 6);
    assert_int_equal(stage.state, HUB_ROLLOUT_RUNNING);
}

static void failures_stop_it(void **state)
{
    struct hub_rollout_stage stage = running();
    struct hub_rollout_count count = {.told = 3, .finished = 3, .failed = 1, .waiting = 20};
    (void)state;
    /* As many as it may have. */
    hub_rollout_move(&stage, &count, 5000);
    assert_int_equal(stage.state, HUB_ROLLOUT_RUNNING);
    assert_int_equal(stage.stage, 2);
    /* One more, while others of the stage are still at work. */
    count = (struct hub_rollout_count){.told = 6, .finished = 5, .failed = 2, .waiting = 17};
    hub_rollout_move(&stage, &count, 6000);
    assert_int_equal(stage.state, HUB_ROLLOUT_STOPPED);
    assert_int_equal(stage.stage, 2);
    /* It does not go on by itself. */
    count = (struct hub_rollout_count){.told = 6, .finished = 6, .failed = 0, .waiting = 17};
    hub_rollout_move(&stage, &count, 9000);
    assert_int_equal(stage.state, HUB_ROLLOUT_STOPPED);
    assert_int_equal(stage.most, 6);
}

static void it_ends_with_the_last_door(void **state)
{
    struct hub_rollout_stage stage = running();
    struct hub_rollout_count count = {.told = 2, .finished = 1, .finished_s = 1000};
    (void)state;
    hub_rollout_move(&stage, &count, 5000);
    assert_int_equal(stage.state, HUB_ROLLOUT_RUNNING);
    count.finished = 2;
    hub_rollout_move(&stage, &count, 1000);
    assert_int_equal(stage.state, HUB_ROLLOUT_DONE);
}

static void doors_share_the_line(void **state)
{
    struct hub_rollout_stage stage = running();
    (void)state;
    /* Three doors, 100 MB each, 12.5 MB a second. */
    assert_int_equal(hub_rollout_spread_s(&stage, 1000, 100000000), 24);
    assert_int_equal(hub_rollout_spread_s(&stage, 2, 100000000), 16); /* there are no more */
    stage.stage = 2;
    stage.most = 50; /* 25 of them in this stage */
    assert_int_equal(hub_rollout_spread_s(&stage, 1000, 100000000), 200);
    assert_int_equal(hub_rollout_spread_s(&stage, 30, 100000000), 40);
    /* Most of its doors have left the rollout; one is told now. */
    assert_int_equal(hub_rollout_spread_s(&stage, 3, 100000000), 8);
    stage.most = 20000;
    assert_int_equal(hub_rollout_spread_s(&stage, 20000, 100000000), HUB_ROLLOUT_SPREAD_MOST_S);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stage_waits_for_its_doors),
        cmocka_unit_test(failures_stop_it),
        cmocka_unit_test(it_ends_with_the_last_door),
        cmocka_unit_test(doors_share_the_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
