/* The openapi.json of the hub and its table of routes say the same. */
#include <jansson.h>
#include <string.h>
#include <strings.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/api/hub_api.h"

static json_t *document(void)
{
    json_error_t error;
    json_t *root = json_loads((const char *)hub_api_document, JSON_REJECT_DUPLICATES, &error);

    if (!root) {
        fail_msg("openapi.json, line %d: %s", error.line, error.text);
    }
    return root;
}

static const struct web_route *find_route(const char *method, const char *path)
{
    const struct web_route *route = hub_api_routes;

    while (route->method &&
           (strcasecmp(route->method, method) != 0 || strcmp(route->path, path) != 0)) {
        route++;
    }
    return route->method ? route : NULL;
}

static void each_path_of_the_document_is_a_route_of_its_role(void **state)
{
    json_t *root = document(), *methods, *description;
    const char *path, *method;
    size_t n = 0, routes = 0;
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
            assert_string_equal(least, web_role_word(route->least));
            n++;
        }
    }
    while (hub_api_routes[routes].method) {
        assert_ptr_equal(find_route(hub_api_routes[routes].method, hub_api_routes[routes].path),
                         &hub_api_routes[routes]);
        routes++;
    }
    assert_int_equal(n, routes); /* so each route is in the document */
    assert_true(n > 30);
    json_decref(root);
}

static void check_references(const json_t *root, json_t *value)
{
    static const char schemas[] = "#/components/schemas/";
    const char *name;
    json_t *member;
    size_t i;

    json_array_foreach(value, i, member)
    {
        check_references(root, member);
    }
    json_object_foreach(value, name, member)
    {
        if (strcmp(name, "$ref") == 0) {
            const char *to = json_string_value(member);
            assert_int_equal(strncmp(to, schemas, sizeof schemas - 1), 0);
            if (!json_object_get(json_object_get(json_object_get(root, "components"), "schemas"),
                                 to + sizeof schemas - 1)) {
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

    check_references(root, root);
    json_decref(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_path_of_the_document_is_a_route_of_its_role),
        cmocka_unit_test(references_lead_to_schemas),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
