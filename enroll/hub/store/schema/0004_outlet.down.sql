DROP TABLE outlet_cursor, outlet;
