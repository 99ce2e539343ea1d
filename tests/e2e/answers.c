#include "tests/e2e/answers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

const char *answer_text(const json_t *object, const char *name)
{
    const char *text = json_string_value(json_object_get(object, name));

    return text ? text : "(none)";
}

json_int_t answer_number(const json_t *object, const char *name)
{
    return json_integer_value(json_object_get(object, name));
}

size_t answer_people(const struct appliance *appliance)
{
    json_t *document = appliance_run_json(appliance, "list", NULL, 0);
    const size_t count = json_array_size(json_object_get(document, "people"));

    json_decref(document);
    return count;
}

void answer_expect_error(const struct appliance *appliance, const char *words, int exit,
                         const char *code)
{
    json_t *document = appliance_run_json(appliance, words, NULL, exit);

    assert_string_equal(answer_text(json_object_get(document, "error"), "code"), code);
    json_decref(document);
}
