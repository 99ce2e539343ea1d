/* A crew runs every task of a batch once, no worker number twice at a time, batch after batch. */
#include <errno.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "firmware/recognise/crew.h"

enum { TASKS_MAX = 40, BATCHES = 300 };

struct count {
    int n_workers;
    atomic_int runs[TASKS_MAX];
    atomic_int busy[ISO_CREW_MAX];
    atomic_int faults;
    uint64_t result[TASKS_MAX];
};

static void work(void *batch, int task, int worker)
{
    struct count *count = batch;
    bool known = worker >= 0 && worker < count->n_workers;
    if (!known || atomic_fetch_add(&count->busy[worker], 1) != 0) {
        atomic_fetch_add(&count->faults, 1);
        return;
    }
    uint64_t value = (uint64_t)task + 1;
    for (int i = 0; i < 2000; i++) { /* so long that others have time to come */
        value = value * UINT64_C(6364136223846793005) + 1442695040888963407u;
    }
    count->result[task] = value;
    atomic_fetch_add(&count->runs[task], 1);
    atomic_fetch_sub(&count->busy[worker], 1);
}

static void every_task_runs_once(void **state)
{
    (void)state;
    static struct count alone;
    alone.n_workers = 1;
    for (int i = 0; i < TASKS_MAX; i++) {
        work(&alone, i, 0);
    }
    for (int n_workers = 1; n_workers <= 4; n_workers++) {
        struct iso_crew *crew = NULL;
        assert_int_equal(iso_crew_new(n_workers, &crew), 0);
        const struct iso_tasks *tasks = iso_crew_tasks(crew);
        assert_int_equal(tasks->n_workers, n_workers);
        for (int b = 0; b < BATCHES; b++) {
            static struct count count;
            count = (struct count){.n_workers = n_workers};
            int n_tasks = b % (TASKS_MAX + 1);
            iso_tasks_run(tasks, work, &count, n_tasks);
            assert_int_equal(count.faults, 0);
            for (int i = 0; i < TASKS_MAX; i++) {
                assert_int_equal(count.runs[i], i < n_tasks);
                assert_true(count.result[i] == (i < n_tasks ? alone.result[i] : 0));
            }
        }
        iso_crew_free(crew);
    }
}

enum { RACERS = 4, RACES = 300 };

/* The results of a race: each is made known once. */
struct race {
    const struct count *alone;
    atomic_int won[TASKS_MAX]; /* 1 + the worker who was first */
    uint64_t own[RACERS][TASKS_MAX];
    atomic_int hold; /* > 0: a helper does not finish until it is let go */
    atomic_bool held, let_go;
};

static void race_for(void *batch, int task, int worker)
{
    struct race *race = batch;
    uint64_t value = (uint64_t)task + 1;
    for (int i = 0; i < 2000; i++) {
        value = value * UINT64_C(6364136223846793005) + 1442695040888963407u;
    }
    race->own[worker][task] = value;
    if (worker > 0 && race->hold > 0) {
        race->held = true;
        while (!race->let_go) {
            (void)sched_yield();
        }
    }
    int nobody = 0;
    (void)atomic_compare_exchange_strong(&race->won[task], &nobody, worker + 1);
}

static void check_race(struct race *race, int n_tasks)
{
    for (int i = 0; i < TASKS_MAX; i++) {
        const int worker = race->won[i] - 1;
        assert_int_equal(worker >= 0, i < n_tasks);
        assert_true(worker < 0 || race->own[worker][i] == race->alone->result[i]);
    }
}

static void a_race_has_every_result(void **state)
{
    (void)state;
    static struct count alone;
    static struct race race;
    alone.n_workers = 1;
    for (int i = 0; i < TASKS_MAX; i++) {
        work(&alone, i, 0);
    }
    for (int n_workers = 1; n_workers <= RACERS; n_workers++) {
        struct iso_crew *crew = NULL;
        assert_int_equal(iso_crew_new(n_workers, &crew), 0);
        const struct iso_tasks *tasks = iso_crew_tasks(crew);
        for (int b = 0; b < RACES; b++) {
            const int n_tasks = b % (TASKS_MAX + 1);
            iso_tasks_settle(tasks);
            race = (struct race){.alone = &alone};
            if (b % 3 == 0) {
                iso_tasks_expect(tasks);
            }
            iso_tasks_race(tasks, race_for, &race, n_tasks);
            check_race(&race, n_tasks);
        }
        iso_tasks_settle(tasks);
        iso_crew_free(crew);
    }
}

/* Races until a helper takes part; whatever it took is done without it. */
static void who_stands_still_in_a_race_is_not_waited_for(void **state)
{
    (void)state;
    static struct count alone;
    static struct race race;
    struct iso_crew *crew = NULL;
    alone.n_workers = 1;
    for (int i = 0; i < TASKS_MAX; i++) {
        work(&alone, i, 0);
    }
    assert_int_equal(iso_crew_new(2, &crew), 0);
    const struct iso_tasks *tasks = iso_crew_tasks(crew);
    do {
        iso_tasks_settle(tasks);
        race = (struct race){.alone = &alone, .hold = 1};
        iso_tasks_expect(tasks);
        iso_tasks_race(tasks, race_for, &race, TASKS_MAX);
        check_race(&race, TASKS_MAX); /* although the helper is still at it */
        for (int i = 0; race.held && i < TASKS_MAX; i++) {
            assert_int_equal(race.won[i], 1);
        }
        race.let_go = true;
    } while (!race.held);
    iso_tasks_settle(tasks);
    iso_crew_free(crew);
}

/* Where the caller is, and what helpers say of where they may be. */
struct places {
    int caller;
    atomic_int seen, shared;
};

static void look_around(void *batch, int task, int worker)
{
    struct places *places = batch;
    cpu_set_t mine;
    (void)task;
    if (worker > 0 && sched_getaffinity(0, sizeof mine, &mine) == 0) {
        atomic_fetch_add(&places->seen, 1);
        atomic_fetch_add(&places->shared, CPU_ISSET((size_t)places->caller, &mine) != 0);
    }
    for (volatile int i = 0; i < 20000; i++) { /* so long that others have time to come */
    }
}

static void who_expects_a_batch_has_its_processor_alone(void **state)
{
    (void)state;
    cpu_set_t all, one;
    if (sched_getaffinity(0, sizeof all, &all) != 0 || CPU_COUNT(&all) < 2) {
        skip();
    }
    struct iso_crew *crew = NULL;
    assert_int_equal(iso_crew_new(3, &crew), 0);
    for (int processor = 0, n = 0; processor < CPU_SETSIZE && n < 2; processor++) {
        if (!CPU_ISSET((size_t)processor, &all)) {
            continue;
        }
        struct places places = {.caller = processor};
        n++;
        CPU_ZERO(&one);
        CPU_SET((size_t)processor, &one);
        assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
        for (int i = 0; i < 10000 && places.seen == 0; i++) {
            iso_tasks_expect(iso_crew_tasks(crew));
            iso_tasks_run(iso_crew_tasks(crew), look_around, &places, 6);
        }
        assert_true(places.seen > 0);
        assert_int_equal(places.shared, 0);
    }
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
    iso_crew_free(crew);
}

static void without_a_crew_the_caller_does_it(void **state)
{
    (void)state;
    static struct count count;
    count.n_workers = 1;
    iso_tasks_run(NULL, work, &count, 12);
    for (int i = 0; i < TASKS_MAX; i++) {
        assert_int_equal(count.runs[i], i < 12);
    }
    assert_int_equal(count.faults, 0);
}

static void sizes_out_of_range_are_refused(void **state)
{
    (void)state;
    struct iso_crew *none = NULL;
    const int sizes[] = {0, -1, ISO_CREW_MAX + 1};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        assert_int_equal(iso_crew_new(sizes[i], &none), -EINVAL);
    }
    assert_null(none);
    iso_crew_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_task_runs_once),
        cmocka_unit_test(a_race_has_every_result),
        cmocka_unit_test(who_stands_still_in_a_race_is_not_waited_for),
        cmocka_unit_test(who_expects_a_batch_has_its_processor_alone),
        cmocka_unit_test(without_a_crew_the_caller_does_it),
        cmocka_unit_test(sizes_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
