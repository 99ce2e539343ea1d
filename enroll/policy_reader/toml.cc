// TOML by toml++, behind a function of C.
#include <cstdio>
#include <new>
#include <string_view>

#include <toml++/toml.h>

#include "enroll/policy_reader/reader_input.h"

namespace
{

json_t *to_json(const toml::node &node, struct reader_line *line);

json_t *table_to_json(const toml::table &table, struct reader_line *line)
{
    json_t *object = json_object();
    for (const auto &[key, value] : table) {
        json_t *member = to_json(value, line);
        if (!member || json_object_setn_new(object, key.str().data(), key.str().size(), member)) {
            json_decref(object);
            return nullptr;
        }
    }
    return object;
}

json_t *array_to_json(const toml::array &array, struct reader_line *line)
{
    json_t *list = json_array();
    for (const auto &value : array) {
        json_t *entry = to_json(value, line);
        if (!entry || json_array_append_new(list, entry)) {
            json_decref(list);
            return nullptr;
        }
    }
    return list;
}

json_t *date_to_json(const toml::date &date)
{
    char text[16];
    (void)std::snprintf(text, sizeof text, "%04u-%02u-%02u", date.year % 10000U, date.month % 100U,
                        date.day % 100U);
    return json_string(text);
}

json_t *to_json(const toml::node &node, struct reader_line *line)
{
    switch (node.type()) {
    case toml::node_type::table:
        return table_to_json(*node.as_table(), line);
    case toml::node_type::array:
        return array_to_json(*node.as_array(), line);
    case toml::node_type::string: {
        const std::string &text = node.as_string()->get();
        if (text.find('\0') != std::string::npos) {
            return reader_refuse(line, "line %u: a text has a zero character",
                                 node.source().begin.line);
        }
        return json_stringn(text.data(), text.size());
    }
    case toml::node_type::integer:
        return json_integer(node.as_integer()->get());
    case toml::node_type::floating_point:
        return json_real(node.as_floating_point()->get());
    case toml::node_type::boolean:
        return json_boolean(node.as_boolean()->get());
    case toml::node_type::date:
        return date_to_json(node.as_date()->get());
    default:
        return reader_refuse(line,
                             "line %u: a time stands in quotes: \"09:00-17:30\" is a period of a "
                             "day",
                             node.source().begin.line);
    }
}

} // namespace

json_t *reader_toml(const char *text, size_t size, struct reader_line *line)
try {
    line->text[0] = '\0';
    const toml::table table = toml::parse(std::string_view(text, size));
    json_t *object = table_to_json(table, line);
    /* Jansson refuses a text with a zero byte, and a number that is none. */
    if (!object && !line->text[0]) {
        return reader_refuse(line, "a value cannot be written as JSON");
    }
    return object;
} catch (const toml::parse_error &error) {
    const std::string_view what = error.description();
    return reader_refuse(line, "line %u, column %u: %.*s", error.source().begin.line,
                         error.source().begin.column, static_cast<int>(what.size()), what.data());
} catch (const std::exception &error) {
    return reader_refuse(line, "%s", error.what());
}
