/* The record of an evaluated design and the table that holds such rows. */
#include "check.h"

#include "evaluate/evaluation.h"

TEST(every_outcome_and_kind_is_found_by_its_word)
{
    for (int k = 0; k < OUTCOME_COUNT; k++)
        assert_int_equal(outcome_of_word(outcome_word((Outcome)k)), k);
    for (int k = 0; k < KIND_COUNT; k++)
        assert_int_equal(kind_of_word(kind_word((EvaluationKind)k)), k);
    assert_int_equal(outcome_of_word("fine"), OUTCOME_COUNT);
    assert_int_equal(kind_of_word(""), KIND_UNFINISHED);
    assert_int_equal(OUTCOME_OK, 0);
}

TEST(rows_keep_their_numbers_while_the_table_grows)
{
    enum { N = 1000 };
    EvaluationTable t = evaluation_table(3, 2, 1);
    Evaluation *e;
    for (int i = 0; i < N; i++) {
        CHECK_OK(evaluation_table_add(&t, &e, &err), &err);
        assert_true(isnan(e->f[1]) && isnan(e->sd[0]) && isnan(e->extra[0]) && isnan(e->seconds) && e->x[2] == 0.0);
        assert_int_equal(e->kind, KIND_UNFINISHED);
        e->id = i + 1;
        for (int d = 0; d < 3; d++)
            e->x[d] = 10.0 * i + d;
        e->f[0] = -i;
        e->extra[0] = 0.5 * i;
    }
    assert_int_equal(t.n, N);
    for (int i = 0; i < N; i++) {
        assert_true(t.row[i].id == i + 1 && t.row[i].x == t.x + 3 * i && t.row[i].f == t.f + 2 * i);
        assert_true(t.x[3 * i + 2] == 10.0 * i + 2.0 && t.f[2 * i] == -i && isnan(t.f[2 * i + 1]));
        assert_same_number(t.row[i].extra[0], 0.5 * i);
    }
    evaluation_table_free(&t);
    assert_true(t.n == 0 && t.n_var == 3);
}

TEST(an_appended_row_is_a_copy_and_what_it_lacks_is_not_known)
{
    OWNED(evaluation_table_free) EvaluationTable t = evaluation_table(2, 2, 0);
    double x[2] = {1.0, 2.0}, f[2] = {3.0, 4.0};
    Evaluation e = {.id = 7, .kind = KIND_REPEAT, .replicates = 3, .violation = 0.25, .x = x, .f = f};
    char room[REASON_MAX];
    e.room = room;
    evaluation_set_outcome(&e, OUTCOME_TIMEOUT, "no answer, \"late\"");
    CHECK_OK(evaluation_table_append(&t, &e, &err), &err);
    x[0] = f[0] = 0.0;
    const Evaluation *row = &t.row[0];
    assert_true(row->id == 7 && row->kind == KIND_REPEAT && row->replicates == 3 && row->violation == 0.25);
    assert_true(row->x[0] == 1.0 && row->f[0] == 3.0 && row->f[1] == 4.0 && isnan(row->sd[0]) && isnan(row->sd[1]));
    assert_int_equal(row->outcome, OUTCOME_TIMEOUT);
    assert_null(strpbrk(row->reason, ",\""));
}

SUITE(NULL, NULL)
