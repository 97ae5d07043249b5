"""The program: operations, instructions, folding rules, groups of results, and the reference evaluator."""
