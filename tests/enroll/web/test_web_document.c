/* openapi.json and the table of routes say the same. */
#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/api/api.h"
#include "enroll/web/api/document.h"

static json_t *document(void)
{
    json_error_t error;
    json_t *root = json_loads((const char *)web_api_document, JSON_REJECT_DUPLICATES, &error);

    if (!root) {
        fail_msg("openapi.json, line %d: %s", error.line, error.text);
    }
    return root;
}

static const struct web_route *find_route(const char *method, const char *path)
{
    for (const struct web_route *route = web_api_routes; route->method; route++) {
        if (strcasecmp(route->method, method) == 0 && strcmp(route->path, path) == 0) {
            return route;
        }
    }
    return NULL;
}

static void each_path_of_the_document_is_a_route(void **state)
{
    json_t *root = document(), *methods, *description;
    const char *path, *method;
    size_t n = 0;
    (void)state;

    json_object_foreach(json_object_get(root, "paths"), path, methods)
    {
        json_object_foreach(methods, method, description)
        {
            const struct web_route *route = find_route(method, path);
            const char *least = json_string_value(json_object_get(description, "x-least-role"));
            if (!route) {
                fail_msg("%s %s is no route", method, path);
            }
            assert_non_null(least);
            if (strcmp(least, web_role_word(route->least)) != 0) {
                fail_msg("%s %s: %s in the document, %s in the table", method, path, least,
                         web_role_word(route->least));
            }
            n++;
        }
    }
    assert_true(n > 0);
    json_decref(root);
}

static void each_route_is_in_the_document(void **state)
{
    json_t *root = document();
    char method[16];
    (void)state;

    for (const struct web_route *route = web_api_routes; route->method; route++) {
        size_t i = 0;
        for (; route->method[i]; i++) {
            method[i] = (char)(route->method[i] - 'A' + 'a');
        }
        method[i] = '\0';
        const json_t *path = json_object_get(json_object_get(root, "paths"), route->path);
        if (!json_object_get(path, method)) {
            fail_msg("%s %s is not in openapi.json", route->method, route->path);
        }
        assert_non_null(route->handle);
        assert_ptr_equal(find_route(route->method, route->path), route);
    }
    json_decref(root);
}

/* References within the document lead somewhere. */
static void check_references(const json_t *root, json_t *value)
{
    const char *name;
    json_t *member;
    size_t i;

    json_array_foreach(value, i, member)
    {
        check_references(root, member);
    }
    json_object_foreach(value, name, member)
    {
        static const char schemas[] = "#/components/schemas/";
        if (strcmp(name, "$ref") == 0) {
            const char *to = json_string_value(member);
            assert_int_equal(strncmp(to, schemas, sizeof schemas - 1), 0);
            const json_t *all = json_object_get(json_object_get(root, "components"), "schemas");
            if (!json_object_get(all, to + sizeof schemas - 1)) {
                fail_msg("%s does not exist", to);
            }
        }
        check_references(root, member);
    }
}

static void references_lead_to_schemas(void **state)
{
    json_t *root = document();
    (void)state;

    assert_string_equal(json_string_value(json_object_get(root, "openapi")), "3.1.0");
    check_references(root, root);
    json_decref(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_path_of_the_document_is_a_route),
        cmocka_unit_test(each_route_is_in_the_document),
        cmocka_unit_test(references_lead_to_schemas),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
