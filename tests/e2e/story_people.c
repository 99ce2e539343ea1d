#include "tests/e2e/story.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "tests/e2e/answers.h"
#include "tests/e2e/appliance.h"

void people_are_enrolled(void **state)
{
    const struct appliance_result *result = appliance_run(*state, "enroll --quick p01",
                                                          "p01-enrol");

    appliance_expect(result, 0);
    assert_non_null(strstr(result->out, "\nstage 1/"));
    assert_non_null(strstr(result->out, "\np01 is enrolled.\n"));

    json_t *document = appliance_run_json(*state, "enroll --quick p02", "p02-enrol", 0);
    assert_string_equal(answer_text(document, "result"), "enroll-completed");
    assert_int_equal(answer_number(document, "stage"), answer_number(document, "stages"));
    const double quality = json_real_value(json_object_get(document, "quality"));
    assert_true(quality > 0 && quality <= 1);
    json_decref(document);
    appliance_expect(appliance_run(*state, "enroll --quick p03", "p03-enrol"), 0);
    assert_int_equal(answer_people(*state), 3);
}

void a_known_face_is_refused_under_another_name(void **state)
{
    json_t *document = appliance_run_json(*state, "enroll --quick double", "p01-enrol", 1);

    assert_string_equal(answer_text(document, "result"), "enroll-duplicate");
    assert_string_equal(answer_text(document, "duplicate_of"), "p01");
    json_decref(document);
    assert_int_equal(answer_people(*state), 3);

    appliance_expect(appliance_run(*state, "enroll --quick double --allow-duplicate", "p01-enrol"),
                     0);
    assert_int_equal(answer_people(*state), 4);
    appliance_expect(appliance_run(*state, "remove double", NULL), 0);
    assert_int_equal(answer_people(*state), 3);
}

void a_used_name_is_for_its_owner_only(void **state)
{
    const struct appliance_result *result = appliance_run(*state, "enroll --quick P03",
                                                          "p03-enrol");

    assert_int_equal(result->exit, 0);
    assert_non_null(strstr(result->out, "p03 has 1 template since "));
    assert_non_null(strstr(result->out, "; this adds to it.\n"));
    assert_non_null(strstr(result->out, "\np03 is enrolled.\n"));
    assert_int_equal(answer_people(*state), 3);

    json_t *document = appliance_run_json(*state, "enroll --quick p03", "p04-enrol", 1);
    assert_string_equal(answer_text(document, "result"), "enroll-other-face");
    assert_int_equal(answer_number(document, "templates_before"), 2);
    json_decref(document);
}

void names_are_checked(void **state)
{
    char words[128] = "enroll --quick ";

    memset(words + strlen(words), 'x', 65);
    answer_expect_error(*state, words, 2, "invalid-name");
    answer_expect_error(*state, "remove zoe", 3, "no-such-person");
    answer_expect_error(*state, "verify zoe", 3, "no-such-person");
}

void people_are_identified(void **state)
{
    json_t *document = appliance_run_json(*state, "identify", "p02-v1", 0);

    assert_string_equal(answer_text(document, "result"), "identify-match");
    assert_string_equal(answer_text(document, "person"), "p02");
    assert_true(json_real_value(json_object_get(document, "score")) >=
                json_real_value(json_object_get(document, "threshold")));
    json_decref(document);

    document = appliance_run_json(*state, "identify", "x02-v1", 1);
    assert_string_equal(answer_text(document, "result"), "identify-no-match");
    json_decref(document);
}

void people_are_verified(void **state)
{
    appliance_expect(appliance_run(*state, "verify p01", "p01-v1"), 0);
    appliance_expect(appliance_run(*state, "verify p02", "p01-v2"), 1);
}

void nobody_before_the_camera_times_out(void **state)
{
    appliance_expect(appliance_run(*state, "identify --timeout 0.3", NULL), 5);
    appliance_expect(appliance_run(*state, "enroll --quick zoe --timeout 0.3", "none-nobody1"), 5);
    assert_int_equal(answer_people(*state), 3);
}
