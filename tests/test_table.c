/* Tables of numbers, and the design files built on them. */
#include "bad_inputs.h"
#include "program.h"

#include "scene/design.h"

static Status parse(Table *t, const char *text, int has_header, Err *why)
{
    return table_parse(t, "there.csv", text, strlen(text), has_header, why);
}

static void expect_refusal(const char *text, int has_header, const char *wanted)
{
    err = (Err){0};
    OWNED(table_free) Table t;
    assert_int_equal(parse(&t, text, has_header, &err), STATUS_BAD_DATA);
    if (!strstr(err.text, wanted))
        print_error("'%s' does not hold '%s'\n", err.text, wanted);
    assert_non_null(strstr(err.text, wanted));
}

TEST(numbers_come_out_as_they_were_written_below_the_names_of_their_columns)
{
    OWNED(table_free) Table t;
    CHECK_OK(parse(&t, " a , b_m_s2,c\n1,-2.5,3e-7\n0.1,1e300,-0\n", 1, &err), &err);
    const double want[] = {1, -2.5, 3e-7, 0.1, 1e300, -0.0};
    assert_int_equal(t.n_rows, 2);
    assert_int_equal(t.n_cols, 3);
    assert_memory_equal(t.values, want, sizeof want);
    assert_true(table_column(&t, "b_m_s2") == 1 && table_column(&t, "a") == 0 && table_column(&t, "b") == -1);
}

TEST(comments_blank_lines_and_foreign_line_ends_are_skipped_and_blanks_part_numbers)
{
    FOR_EACH (const char *, text, "# who\r\n\r\n  # what\r\n 1 , 2 \r\n\r\n\t3\t,4\r\n# end",
              "#\n   1.0e+00  2\n3\t 4 \n", "1,0 2,0\n3,0 4,0") {
        OWNED(table_free) Table t;
        CHECK_OK(parse(&t, *text, 0, &err), &err);
        const double want[] = {1, 2, 3, 4};
        assert_int_equal(t.n_rows, 2);
        assert_null(t.names);
        assert_memory_equal(t.values, want, sizeof want);
    }
}

TEST(each_fault_names_file_line_and_column)
{
    expect_refusal("1,2\n3\n", 0, "there.csv:2: column 2 of 2 is missing");
    expect_refusal("1,2\n3,4,5\n", 0, "there.csv:2: more than 2 columns");
    expect_refusal("1,2\n3,4,\n", 0, "there.csv:2: more than 2 columns");
    expect_refusal("1,2\n,4\n", 0, "there.csv:2: column 1 of 2 is missing");
    expect_refusal("# c\n\n1,2\n3,x\n", 0, "there.csv:4: column 2");
    expect_refusal("1 2\n3 4 5\n", 0, "there.csv:2: more than 2 columns");
    expect_refusal("a b\n1 2\n", 1, "there.csv:2: column 1 is not a number");
    expect_refusal("1,2m\n", 0, "there.csv:1: ");
    expect_refusal("1,nan\n", 0, "there.csv:1: column 2 is nan");
    expect_refusal("1,-inf\n", 0, "there.csv:1: column 2 is -inf");
    expect_refusal("1,2\n#VALUE!,3\n# a comment\n4,5\n", 0, "there.csv:2: column 1 is not a number: '#VALUE!'");
    expect_refusal("1\n#DIV/0!\n", 0, "there.csv:2: column 1");
    expect_refusal("1;2\n#NV;3\n", 0, "there.csv:2: column 1");
    expect_refusal("1,1e999\n", 0, "there.csv:1: column 2 is inf");
    expect_refusal("", 0, "holds no numbers");
    expect_refusal("# nothing\n", 0, "holds no numbers");
    OWNED(table_free) Table t;
    CHECK_OK(table_parse(&t, "names", "a,b\n", 4, 1, &(Err){0}), &(Err){0}); /* names alone are an empty table */
    assert_true(t.n_rows == 0 && t.n_cols == 2);
}

/* A trailing comma must not fetch its number from the line below. */
TEST(a_missing_last_number_is_not_taken_from_the_next_line)
{
    expect_refusal("1,2,3\n4,5,\n6,7,8\n", 0, "there.csv:2: column 3 of 3 is missing");
}

TEST(a_missing_file_is_told_from_a_bad_one)
{
    Table t;
    assert_refused(table_read(&t, "tests/bad/not_there.csv", 0, &err), STATUS_MISSING, "tests/bad/not_there.csv");
    assert_int_equal(table_read(&t, "tests", 0, &err), STATUS_MISSING);
}

/* The same 2 x 3 numbers as a spreadsheet of several countries writes them. */
TEST(the_forms_of_spreadsheets_hold_the_same_numbers)
{
    const double want[] = {1.5, -2.25, 3e-7, 0.1, 4, 5};
    FOR_EACH (const char *, form, "1.5,-2.25,3e-7\n0.1,4,5\n", "\xef\xbb\xbfsep=;\r\n1,5;-2,25;3e-7\r\n0,1;4;5\r\n",
              "\357\273\2771.5,-2.25,3e-7\r\n0.1,4,5\r\n", "1.5;-2.25;3e-7\n0.1;4;5\n", "1,5;-2,25;3e-7\n0,1;4;5\n",
              "1.5\t-2.25\t3e-7\n0.1\t4\t5\n", "1,5\t-2,25\t3e-7\r\n0,1\t4\t5\r\n",
              "\"1,5\",\"-2,25\",\"3e-7\"\n\"0,1\",4,5\n", "\"1.5\";\"-2.25\";\"3e-7\"\n0.1;4;5\n;;\n;;\n",
              "# made by hand\r1.5 , -2.25 , 3e-7\r0.1 , 4 , 5\r") {
        OWNED(table_free) Table t;
        CHECK_OK(parse(&t, *form, 0, &err), &err);
        assert_int_equal(t.n_rows, 2);
        assert_int_equal(t.n_cols, 3);
        assert_memory_equal(t.values, want, sizeof want);
    }
}

TEST(a_header_of_a_spreadsheet_loses_its_mark_and_its_quotes)
{
    FOR_EACH (const char *, form, "\xef\xbb\xbfgap_01_m,t_base_m\n0.05,0.012\n",
              "\xef\xbb\xbfgap_01_m;t_base_m\r\n0,05;0,012\r\n", "\"gap_01_m\"\t\"t_base_m\"\n0,05\t0,012\n",
              "\"gap_01_m\",\"t_base_m\"\n\"0,05\",\"0,012\"\n") {
        OWNED(table_free) Table t;
        CHECK_OK(parse(&t, *form, 1, &err), &err);
        assert_int_equal(table_column(&t, "gap_01_m"), 0);
        assert_int_equal(table_column(&t, "t_base_m"), 1);
        assert_true(t.n_rows == 1 && t.values[0] == 0.05 && t.values[1] == 0.012);
        assert_int_equal(t.line[0], 2);
    }
}

TEST(decimal_points_beside_decimal_commas_are_refused)
{
    expect_refusal("1,5;2\n3;4\n5;6.5\n", 0, "there.csv:3: decimal points and decimal commas are mixed; line 1");
    expect_refusal("1.234,5;2\n", 0, "there.csv:1: column 1 is not a number");
    expect_refusal("1;2\n3;;\n", 0, "there.csv:2: column 2 of 2 is missing");
    expect_refusal("1\t2\n3\n", 0, "there.csv:2: column 2 of 2 is missing");
    expect_refusal("1\t2\n\t3\n", 0, "there.csv:2: column 1 of 2 is missing");
    expect_refusal("\xff\xfe"
                   "1;2\n",
                   0, "UTF-16");
}

TEST(an_invisible_character_is_named_in_a_message)
{
    expect_refusal("1,2\xc2\xa0"
                   "000\n",
                   0, "column 2 is not a number: '2<U+00A0>000'");
    expect_refusal("1,\xe2\x80\x8b"
                   "2\n",
                   0, "'<U+200B>2'");
    expect_refusal("1,2\x1b[2J\n", 0, "'2\\x1B[2J'");
    expect_refusal("1,\xe4 \n", 0, "'\\xE4'");
    expect_refusal("1,Stra\xc3\x9f"
                   "e\n",
                   0,
                   "'Stra\xc3\x9f"
                   "e'");
    (fail)(&err, STATUS_BAD_DATA, "'%s'", "\xef\xbb\xbf\t\r\n\x7f\xf0\x9f\x99\x82\xc0\x80\xed\x9f\xbf");
    assert_string_equal(err.text, "'<U+FEFF>\\t\\r\\n\\x7F\xf0\x9f\x99\x82\\xC0\\x80\xed\x9f\xbf'");
}

static const char DESIGNS[] = "# two designs for two floors\n"
                              "gap_01_m,gap_02_m,t_base_m,t_top_m\n"
                              "\n"
                              "0.01,0,0.012,0.0064\n"
                              "# the thick one\n"
                              "0.03,0.04,0.02,0.03\n";

static const DesignSpace *paper_space(int n_floors)
{
    static DesignSpace space;
    CHECK_OK(design_space_make(&space, &(DesignOptions){0}, CORE_BOX, n_floors, &err), &err);
    return &space;
}

TEST(a_design_file_gives_its_rows_and_their_lines)
{
    OWNED(design_free) Designs d;
    write_in_place("designs.csv", DESIGNS);
    CHECK_OK(design_read(&d, there("designs.csv"), paper_space(2), &err), &err);
    const double want[] = {0.01, 0, 0.012, 0.0064, 0.03, 0.04, 0.02, 0.03};
    assert_int_equal(d.n, 2);
    assert_memory_equal(d.x, want, sizeof want);
    assert_int_equal(d.line[0], 4);
    assert_int_equal(d.line[1], 6);
}

TEST(variables_are_named_by_floor_from_the_bottom)
{
    static const char *const WANT[] = {"gap_01_m", "gap_02_m", "gap_03_m", "t_base_m", "t_top_m"};
    char name[TABLE_NAME_MAX];
    for (int j = 0; j < 5; j++) {
        design_variable_name(paper_space(3), j, name);
        assert_string_equal(name, WANT[j]);
    }
}

static Status read_two_floors(const char *path, Err *why)
{
    OWNED(design_free) Designs d;
    return design_read(&d, path, paper_space(2), why);
}

TEST(every_bad_design_file_is_refused_with_its_fault)
{
    assert_at_most(15, all_refused("tests/bad/design", read_two_floors));
}

TEST(a_named_pipe_is_refused_before_it_is_waited_for)
{
    char *text;
    size_t length;
    assert_int_equal(mkfifo(there("pipe"), 0600), 0);
    assert_refused(file_read(there("pipe"), FILE_LARGEST, &text, &length, &err), STATUS_MISSING, "is a named pipe");
}

SUITE(make_place, clear_place)
